#include "models/structural_damping.hpp"

#include <Eigen/QR>
#include <cmath>

#include "models/pi.hpp"

namespace wems {
namespace {

constexpr double corner_ratio = 4.89;
constexpr int fit_points = 41;

StructuralBranches calcBranches() {
    const Band band = structuralBand();
    const double middle = std::sqrt(band.lower * band.upper);
    StructuralBranches result{};
    for (int j = 0; j < 3; ++j) {
        result.branch[j].time_constant = 1 / (kTwoPi * middle * std::pow(corner_ratio, j - 1));
    }
    Eigen::Matrix<double, fit_points, 3> loss;
    for (int i = 0; i < fit_points; ++i) {
        const double omega = kTwoPi * band.lower * std::pow(band.upper / band.lower, i / (fit_points - 1.0));
        for (int j = 0; j < 3; ++j) {
            const double u = omega * result.branch[j].time_constant;
            loss(i, j) = u / (1 + u * u);
        }
    }
    const Eigen::Vector3d stiffness = loss.colPivHouseholderQr().solve(Eigen::Matrix<double, fit_points, 1>::Ones());
    for (int j = 0; j < 3; ++j) {
        MaxwellBranch& branch = result.branch[j];
        branch.stiffness = stiffness[j];
        const double u = kTwoPi * middle * branch.time_constant;
        result.storage_in_middle += branch.stiffness * u * u / (1 + u * u);
    }
    return result;
}

}  // namespace

Band structuralBand() {
    return {5.0, 50.0};
}

double largestLossFactor() {
    return 1 / structuralBranches().storage_in_middle;
}

const StructuralBranches& structuralBranches() {
    static const StructuralBranches branches = calcBranches();
    return branches;
}

}  // namespace wems
