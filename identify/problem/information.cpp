#include "identify/problem/information.hpp"

#include <Eigen/Dense>
#include <vector>

namespace wems::identify {
void BlockInformation::add(const BlockInformation& other) {
    if (other.empty()) return;
    if (empty()) {
        *this = other;
        return;
    }
    A += other.A;
    b += other.b;
    if (noise_slopes.size() == 0) {
        noise_slopes = other.noise_slopes;
    } else if (other.noise_slopes.size() > 0) {
        Eigen::MatrixXd both(noise_slopes.rows(), noise_slopes.cols() + other.noise_slopes.cols());
        both << noise_slopes, other.noise_slopes;
        noise_slopes = both;
    }
    Eigen::VectorXd levels(noise_levels.size() + other.noise_levels.size());
    levels << noise_levels, other.noise_levels;
    noise_levels = levels;
    const auto sum = [](auto& own, const auto& added) {
        if (own.size() == 0)
            own = added;
        else if (added.size() > 0)
            own += added;
    };
    sum(scatter, other.scatter);
    sum(noise, other.noise);
    sum(noise_right, other.noise_right);
    sum(growth, other.growth);
    sum(growth_right, other.growth_right);
    chi_squared += other.chi_squared;
    count += other.count;
}

void add(Information& sum, const Information& other) {
    for (std::size_t k = 0; k < kBlocks; ++k) sum[k].add(other[k]);
}

Eigen::MatrixXd calcGrowth(const BlockInformation& block) {
    const double misfit = block.chi_squared / block.count;
    if (!(misfit > 1) || block.noise_slopes.cols() == 0) return {};
    const Eigen::VectorXd s = block.noise_slopes.rowwise().sum(), b = block.b - s / misfit;
    const Eigen::MatrixXd product = (b - 0.5 * (1 - 1 / misfit) * s) * s.transpose() / block.chi_squared;
    return product + product.transpose();
}

BlockInformation combine(const Information& information, const BlockScales& scales, const Eigen::VectorXd& reach,
                         Growth growth) {
    const bool followed = growth == Growth::followed;
    BlockInformation sum;
    for (std::size_t k = 0; k < kBlocks; ++k) {
        BlockInformation scaled = information[k];
        if (scaled.empty()) continue;
        scaled.noise_slopes /= scales[k].scale;
        scaled.A /= scales[k].scale;
        scaled.b /= scales[k].scale;
        if (scaled.noise_slopes.size() > 0) scaled.b -= scaled.noise_slopes.rowwise().sum();
        scaled.chi_squared /= scales[k].scale;
        if (followed && scaled.growth.size() > 0) {
            scaled.A -= scaled.growth / scales[k].scale;
            if (scaled.growth_right.size() > 0) scaled.b += scaled.growth_right / scales[k].scale;
        }
        // In a step V is of noise alone. In a rank it stands for the bursts of what a wrong model leaves, too.
        if (scaled.scatter.size() > 0) scaled.scatter /= followed ? scales[k].scale * scales[k].scale : scales[k].scale;
        // The columns' noise is that of the channels, whatever a wrong model leaves.
        const double level = std::min(1.0, scales[k].level) / scales[k].scale;
        if (scaled.noise.size() > 0) scaled.noise *= level;
        if (scaled.noise_right.size() > 0) scaled.b += level * scaled.noise_right;
        sum.add(scaled);
    }
    if (sum.empty()) return sum;
    // What the recordings do not see is known to its reach.
    std::vector<Eigen::Index> seen;
    for (Eigen::Index i = 0; i < sum.b.size(); ++i)
        if (sum.A(i, i) > 0) seen.push_back(i);
    const Eigen::MatrixXd A = sum.A(seen, seen);
    Eigen::MatrixXd slopes = sum.noise_slopes(seen, Eigen::all);
    if (followed) slopes *= sum.noise_levels.cwiseMax(1.0).cwiseInverse().asDiagonal();
    Eigen::MatrixXd C = A;
    C.diagonal() += reach(seen).cwiseAbs2().cwiseInverse();
    if (sum.scatter.size() > 0) C += sum.scatter(seen, seen);
    C.noalias() += kLevelDeviation * kLevelDeviation * slopes * slopes.transpose();
    const Eigen::LLT<Eigen::MatrixXd> factor(C);
    // A' C⁻¹ A' with the root of C, so that it stays symmetric.
    Eigen::MatrixXd signal = A;
    if (sum.noise.size() > 0) signal -= sum.noise(seen, seen);
    const Eigen::MatrixXd half = factor.matrixL().solve(signal);
    const Eigen::VectorXd b = half.transpose() * factor.matrixL().solve(sum.b(seen));
    const Eigen::Index count = seen.size();
    Eigen::MatrixXd product = Eigen::MatrixXd::Zero(count, count);
    product.selfadjointView<Eigen::Lower>().rankUpdate(half.transpose());
    product.triangularView<Eigen::StrictlyUpper>() = product.transpose();
    sum.A.setZero();
    sum.A(seen, seen) = product;
    sum.b.setZero();
    sum.b(seen) = b;
    return sum;
}

}  // namespace wems::identify
