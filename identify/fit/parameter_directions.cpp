#include "identify/fit/parameter_directions.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "identify/fit/identifiability.hpp"

namespace wems::identify {
namespace {

constexpr double kLeastMember = 0.3;  // of the largest member, to be written
constexpr std::size_t kMostMembers = 4;

std::string describe(const std::vector<Parameter>& parameters, const Eigen::VectorXd& direction) {
    const double largest = direction.cwiseAbs().maxCoeff();
    std::vector<int> members;
    for (Eigen::Index j = 0; j < direction.size(); ++j)
        if (std::abs(direction[j]) >= kLeastMember * largest) members.push_back(static_cast<int>(j));
    std::stable_sort(members.begin(), members.end(),
                     [&](int a, int b) { return std::abs(direction[a]) > std::abs(direction[b]); });
    const bool cut = members.size() > kMostMembers;
    if (cut) members.resize(kMostMembers);
    const Eigen::VectorXd factors = direction(members);
    return formatCombination(parameters, members, factors) + (cut ? " + …" : "");
}

}  // namespace

std::vector<ParameterDirection> findDirections(const std::vector<Parameter>& parameters,
                                               const Eigen::MatrixXd& information, const Eigen::MatrixXd& covariance) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information);
    std::vector<ParameterDirection> directions;
    for (Eigen::Index d = information.rows() - 1; d >= 0; --d) {
        const Eigen::VectorXd direction = eigen.eigenvectors().col(d);
        Eigen::Index largest = 0;
        direction.cwiseAbs().maxCoeff(&largest);
        ParameterDirection entry;
        entry.singular_value = std::sqrt(std::max(0.0, eigen.eigenvalues()[d]));
        entry.relative_error = std::sqrt(std::max(0.0, direction.dot(covariance * direction)));
        entry.known = entry.relative_error < calcTolerance(parameters[largest]);
        entry.text = describe(parameters, direction[largest] < 0 ? Eigen::VectorXd(-direction) : direction);
        directions.push_back(std::move(entry));
    }
    return directions;
}

}  // namespace wems::identify
