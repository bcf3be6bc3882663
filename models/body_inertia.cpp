#include "models/body_inertia.hpp"

#include <Eigen/Eigenvalues>

namespace wems {
namespace {

bool isOfBody(const Eigen::Matrix3d& inertia) {
    return findInertiaProblem(calcPrincipalMoments(inertia)).empty();
}

}  // namespace

Eigen::Vector3d calcPrincipalMoments(const Eigen::Matrix3d& inertia) {
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
}

std::string findInertiaProblem(const Eigen::Vector3d& principal) {
    if (!(principal[0] > 0)) return "principal moments above 0, kg m^2";
    // A flat body meets the limit exactly; rounding must not turn it down.
    if (principal[2] > (principal[0] + principal[1]) * (1 + 1e-9))
        return "a real body's: no principal moment above the sum of the other two";
    return {};
}

Eigen::Matrix3d limitInertia(const Eigen::Matrix3d& believed, const Eigen::Matrix3d& wanted) {
    if (isOfBody(wanted)) return wanted;
    constexpr int halvings = 40;  // to 1e-12 of the way
    constexpr double kept = 0.99;
    const Eigen::Matrix3d way = wanted - believed;
    double inside = 0, outside = 1;
    for (int i = 0; i < halvings; ++i) {
        const double middle = 0.5 * (inside + outside);
        (isOfBody(believed + middle * way) ? inside : outside) = middle;
    }
    return believed + kept * inside * way;
}

}  // namespace wems
