#include "identify/component/block_regression.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/fit/intervals.hpp"
#include "identify/motion/noise_estimate.hpp"

namespace wems::identify {

namespace {

std::vector<Eigen::Index> makeBlocks(Eigen::Index count, const std::vector<Eigen::Index>& run_starts,
                                     Eigen::Index block_length) {
    std::vector<Eigen::Index> starts;
    for (std::size_t run = 0; run < run_starts.size(); ++run) {
        const Eigen::Index begin = run_starts[run];
        const Eigen::Index end = run + 1 < run_starts.size() ? run_starts[run + 1] : count;
        const auto blocks = std::max<Eigen::Index>(1, (end - begin) / block_length);
        for (Eigen::Index b = 0; b < blocks; ++b) starts.push_back(begin + b * (end - begin) / blocks);
    }
    return starts;
}

}  // namespace

double Estimates::calcHalfWidth(const Eigen::VectorXd& combination) const {
    const double variance = combination.dot(covariance * combination);
    if (!(variance >= 0)) return std::numeric_limits<double>::infinity();
    return studentQuantile95(degrees_of_freedom) * std::sqrt(variance);
}

double Estimates::calcHalfWidth(Eigen::Index parameter) const {
    const double variance = covariance(parameter, parameter);
    return std::isfinite(variance) ? studentQuantile95(degrees_of_freedom) * std::sqrt(variance)
                                   : std::numeric_limits<double>::infinity();
}

Estimates solveBlocks(const Eigen::MatrixXd& X, const Eigen::VectorXd& y, const std::vector<Eigen::Index>& run_starts) {
    const Eigen::Index n = X.rows(), p = X.cols();
    // Columns scaled to unit norm: metres and newtons differ by many powers of ten.
    Eigen::VectorXd scale = X.colwise().norm();
    for (auto& s : scale) s = s > 0 ? s : 1.0;
    const Eigen::MatrixXd scaled = X * scale.cwiseInverse().asDiagonal();
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
    decomposition.setThreshold(1e-10);
    decomposition.compute(scaled);
    Estimates e;
    e.value = scale.cwiseInverse().asDiagonal() * decomposition.solve(y);
    e.residual = y - X * e.value;
    const double mean = y.mean();
    const double spread = (y.array() - mean).matrix().norm();
    e.fraction = spread > 0 ? e.residual.norm() / spread : 0.0;
    e.correlation_length = calcCorrelationLength(e.residual);

    // Two correlation lengths in a block where the record allows it, 24 blocks at most, never fewer than p + 6.
    const auto wanted = static_cast<Eigen::Index>(static_cast<double>(n) / (2.0 * e.correlation_length));
    const Eigen::Index blocks = std::min(std::max<Eigen::Index>(p + 6, std::min<Eigen::Index>(wanted, 24 + p)), n);
    const auto starts = makeBlocks(n, run_starts, std::max<Eigen::Index>(1, n / blocks));
    e.blocks = static_cast<int>(starts.size());
    e.degrees_of_freedom = static_cast<double>(e.blocks) - static_cast<double>(p);
    Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(p, p);
    for (std::size_t b = 0; b < starts.size(); ++b) {
        const Eigen::Index end = b + 1 < starts.size() ? starts[b + 1] : n;
        const Eigen::Index length = end - starts[b];
        const Eigen::VectorXd score =
            scaled.middleRows(starts[b], length).transpose() * e.residual.segment(starts[b], length);
        meat += score * score.transpose();
    }
    meat *= static_cast<double>(e.blocks) / std::max(1.0, e.degrees_of_freedom);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> normal((scaled.transpose() * scaled).eval());
    Eigen::VectorXd inverse = normal.eigenvalues();
    bool deficient = false;
    for (auto& value : inverse) {
        const bool usable = value > 1e-10 * normal.eigenvalues().maxCoeff();
        deficient |= !usable;
        value = usable ? 1.0 / value : 0.0;
    }
    const Eigen::MatrixXd bread = normal.eigenvectors() * inverse.asDiagonal() * normal.eigenvectors().transpose();
    e.covariance = scale.cwiseInverse().asDiagonal() * (bread * meat * bread) * scale.cwiseInverse().asDiagonal();
    if (deficient) {
        for (Eigen::Index j = 0; j < p; ++j) {
            double missing = 0;  // share of the parameter in directions that the data say nothing about
            for (Eigen::Index k = 0; k < p; ++k)
                if (inverse[k] == 0) missing += std::pow(normal.eigenvectors()(j, k), 2);
            if (missing > 1e-6) e.covariance(j, j) = std::numeric_limits<double>::infinity();
        }
    }
    return e;
}

}  // namespace wems::identify
