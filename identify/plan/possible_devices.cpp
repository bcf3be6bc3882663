#include "identify/plan/possible_devices.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "models/model_tolerance.hpp"
#include "models/parameter_access.hpp"

namespace wems::identify {
namespace {

constexpr int kMostDraws = 100;  // of a clearance, until one lies where the runs leave it possible

double deviationOf(const MountModel& model, const std::string& name) {
    return 0.5 * parameterTolerance(model, name).value_or(0);
}

}  // namespace

PossibleDevices::PossibleDevices(const FitResult& now, const MountModel& model)
    : model_(model), fitted_(now.model), names_(now.estimate.names) {
    const JointEstimate& estimate = now.estimate;
    const auto size = static_cast<Eigen::Index>(names_.size());
    Eigen::VectorXd believed(size), variance(size);
    for (Eigen::Index j = 0; j < size; ++j) {
        believed[j] = getParameter(model, names_[j]);
        variance[j] = std::pow(deviationOf(model, names_[j]), 2);
    }
    // In units of the fit's own deviations: numbers of different units share one matrix.
    const Eigen::VectorXd unit = estimate.covariance.diagonal().cwiseSqrt().cwiseMax(1e-300);
    const Eigen::MatrixXd scaled =
        unit.cwiseInverse().asDiagonal() * estimate.covariance * unit.cwiseInverse().asDiagonal();
    const Eigen::MatrixXd both = scaled + Eigen::MatrixXd(variance.cwiseQuotient(unit.cwiseAbs2()).asDiagonal());
    const Eigen::MatrixXd gain = both.completeOrthogonalDecomposition().solve(scaled).transpose();
    mean_ = estimate.values + unit.cwiseProduct(gain * (believed - estimate.values).cwiseQuotient(unit));
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled - gain * scaled);
    root_ = unit.asDiagonal() * eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
    for (const auto& [clearance, noticed] : now.unreached)
        unreached_.push_back({clearance, clearance.substr(0, clearance.rfind('.')) + ".stiffness", noticed});
}

MountModel PossibleDevices::draw(std::mt19937_64& random) const {
    std::normal_distribution<double> normal(0, 1);
    Eigen::VectorXd standard(root_.cols());
    for (double& value : standard) value = normal(random);
    const Eigen::VectorXd values = mean_ + root_ * standard;
    MountModel device = fitted_;
    for (Eigen::Index j = 0; j < values.size(); ++j) setParameter(device, names_[j], values[j]);
    for (const UnreachedStop& stop : unreached_) {
        const double believed = getParameter(model_, stop.clearance), deviation = deviationOf(model_, stop.clearance);
        double clearance = believed + deviation * normal(random);
        for (int draw = 1; draw < kMostDraws && clearance < stop.noticed; ++draw)
            clearance = believed + deviation * normal(random);
        setParameter(device, stop.clearance, std::max(clearance, stop.noticed));
        setParameter(device, stop.stiffness,
                     getParameter(model_, stop.stiffness) + deviationOf(model_, stop.stiffness) * normal(random));
    }
    makeAdmissible(model_, device);
    return device;
}

}  // namespace wems::identify
