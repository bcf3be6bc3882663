#include "identify/motion/gain_scatter.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "identify/motion/rigid_fit.hpp"

namespace wems::identify {
namespace {

constexpr double kVisible = 5e-4;  // standard error of a gain, beyond which noise hides what calibration scatters by
// Of the largest information: gains of channels that move less than a hundredth of the others are not told from what
// the rigid fit leaves of the large motions.
constexpr double kLeastInformation = 1e-4;
constexpr double kSignificant = 30;  // of the mean square of visible gains over that of noise

}  // namespace

Calibration estimateCalibration(const ChannelSet& set, const Eigen::MatrixXd& residuals, double noise) {
    Calibration calibration;
    for (const MarkerChannel& channel : set.channels) calibration.channels.push_back(channel.name);
    calibration.design = makeDesign(set.channels, Eigen::Vector3d::Zero(), 1.0);
    const bool weighted = std::any_of(set.channels.begin(), set.channels.end(),
                                      [](const MarkerChannel& channel) { return channel.weight != 1; });
    if (set.count() <= 6 || weighted || !std::isfinite(noise)) return calibration;
    const Eigen::MatrixXd pseudo_inverse = calibration.design.completeOrthogonalDecomposition().pseudoInverse();
    const Eigen::MatrixXd left =
        Eigen::MatrixXd::Identity(set.count(), set.count()) - calibration.design * pseudo_inverse;
    const Eigen::VectorXd mean = set.values.rowwise().mean();
    const Eigen::MatrixXd signals = set.values.colwise() - mean;
    const Eigen::MatrixXd normal = left.cwiseProduct(signals * signals.transpose());
    const Eigen::VectorXd right = signals.cwiseProduct(residuals).rowwise().sum();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(normal);
    const double least = kLeastInformation * solver.eigenvalues().maxCoeff();
    double squares = 0, from_noise = 0;
    int visible = 0;
    for (Eigen::Index k = 0; k < right.size(); ++k) {
        const double information = solver.eigenvalues()(k);
        if (!(information > least) || noise > kVisible * std::sqrt(information)) continue;
        squares += std::pow(solver.eigenvectors().col(k).dot(right) / information, 2);
        from_noise += noise * noise / information;
        ++visible;
    }
    if (visible > 0 && squares > kSignificant * from_noise)
        calibration.gain_scatter = std::sqrt((squares - from_noise) / visible);
    return calibration;
}

}  // namespace wems::identify
