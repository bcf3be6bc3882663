#include "identify/problem/information.hpp"

#include <Eigen/Cholesky>

namespace wems::identify {
namespace {

// The noise's level in a band: what its estimate by quartiles, the smoothing of its spectrum and the anti-alias filter
// leave open. The misfits of exact models (0.8 to 1.1) lie within one and a half of it.
constexpr double kLevelDeviation = 0.3;

}  // namespace

void BlockInformation::add(const BlockInformation& other) {
    if (other.empty()) return;
    if (empty()) {
        *this = other;
        return;
    }
    A += other.A;
    b += other.b;
    Eigen::MatrixXd both(noise_slopes.rows(), noise_slopes.cols() + other.noise_slopes.cols());
    both << noise_slopes, other.noise_slopes;
    noise_slopes = both;
    chi_squared += other.chi_squared;
    count += other.count;
}

void add(Information& sum, const Information& other) {
    for (std::size_t k = 0; k < kBlocks; ++k) sum[k].add(other[k]);
}

BlockInformation combine(const Information& information, const BlockScales& scales, const Eigen::VectorXd& reach) {
    BlockInformation sum;
    for (std::size_t k = 0; k < kBlocks; ++k) {
        BlockInformation scaled = information[k];
        if (scaled.empty()) continue;
        scaled.noise_slopes *= scales[k].level / scales[k].scale;
        scaled.A /= scales[k].scale;
        scaled.b = scaled.b / scales[k].scale - scaled.noise_slopes.rowwise().sum();
        scaled.chi_squared /= scales[k].scale;
        sum.add(scaled);
    }
    if (sum.empty() || sum.noise_slopes.cols() == 0) return sum;
    // A C⁻¹ A = A − S (1/τ² + Sᵀ A⁻¹ S)⁻¹ Sᵀ (Woodbury), with what the recordings do not see known to its reach.
    Eigen::MatrixXd regular = sum.A;
    regular.diagonal() += reach.cwiseAbs2().cwiseInverse();
    const Eigen::LLT<Eigen::MatrixXd> factor(regular);
    const Eigen::MatrixXd solved = factor.solve(sum.noise_slopes);
    Eigen::MatrixXd inner = sum.noise_slopes.transpose() * solved;
    inner.diagonal().array() += 1 / (kLevelDeviation * kLevelDeviation);
    const Eigen::MatrixXd weights = inner.ldlt().solve(sum.noise_slopes.transpose());
    sum.b -= weights.transpose() * (solved.transpose() * sum.b);
    sum.A -= sum.noise_slopes * weights;
    return sum;
}

}  // namespace wems::identify
