#include "identify/fit/output_error_interval.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "identify/fit/intervals.hpp"
#include "identify/motion/real_transform.hpp"

namespace wems::identify {

namespace {

// Stretches of all runs whose scores count as independent: many more than a 95 % interval needs (with 40 it is 3 %
// wider than with ever so many), each still some hundred samples.
constexpr Eigen::Index kStretches = 40;
constexpr Eigen::Index kStretchesOfPiece = 10;  // of a piece of twenty periods: two periods, so that scores are apart
constexpr double kNotKnown = 2;                 // standard error of a direction, in scales: the data do not tell it

/// Sum over all frequencies of J̃ᴴ P J̃: columns and residual of one run, rows of one sample after those of the other.
Eigen::MatrixXd calcStationaryNoise(const TrajectoryTangent& tangent) {
    const Eigen::Index axes = tangent.axes, samples = tangent.residual.size() / axes;
    const Eigen::Index columns = tangent.jacobian.cols();
    const RealTransform transform(samples);
    const Eigen::Index bins = transform.binCount();
    const auto rowOf = [&](const auto& stacked, Eigen::Index axis) {
        return Eigen::VectorXd(stacked(Eigen::seqN(axis, samples, axes)));
    };
    Eigen::MatrixXcd residual(bins, axes), derivatives(bins, axes * columns);
    for (Eigen::Index i = 0; i < axes; ++i) {
        residual.col(i) = transform.forward(rowOf(tangent.residual, i));
        for (Eigen::Index j = 0; j < columns; ++j)
            derivatives.col(j * axes + i) = transform.forward(rowOf(tangent.jacobian.col(j), i));
    }
    // Neighbours that count as one. More of them with the run, but ever less of its band, so that a resonance stays
    // one.
    const auto together = static_cast<Eigen::Index>(std::ceil(std::cbrt(static_cast<double>(bins))));
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(columns, columns);
    for (Eigen::Index from = 0; from < bins; from += together) {
        const Eigen::Index count = std::min(together, bins - from);
        const Eigen::MatrixXcd part = residual.middleRows(from, count);
        const Eigen::MatrixXcd power = part.transpose() * part.conjugate() / static_cast<double>(count);
        for (Eigen::Index bin = from; bin < from + count; ++bin) {
            const Eigen::MatrixXcd J = derivatives.row(bin).transpose().reshaped(axes, columns);
            const bool alone = bin == 0 || 2 * bin == samples;
            sum += (alone ? 1 : 2) * (J.adjoint() * power * J).real();
        }
    }
    const auto n = static_cast<double>(samples);
    return sum / (n * n);
}

}  // namespace

OutputErrorUncertainty::OutputErrorUncertainty(Eigen::Index unknowns)
    : information_(Eigen::MatrixXd::Zero(unknowns, unknowns)), noise_(information_) {}

void OutputErrorUncertainty::add(const TrajectoryTangent& tangent, double weight, std::size_t pieces) {
    const std::vector<Eigen::Index>& at = tangent.unknowns;
    information_(at, at) += weight * tangent.jacobian.transpose() * tangent.jacobian;
    noise_(at, at) += weight * weight * calcStationaryNoise(tangent);
    const Eigen::Index samples = tangent.residual.size() / tangent.axes;
    const auto all = static_cast<Eigen::Index>(pieces);
    const Eigen::Index share = pieces == 1 ? kStretches : std::min(kStretchesOfPiece, (kStretches + all - 1) / all);
    const Eigen::Index stretches = std::min(share, samples);
    for (Eigen::Index b = 0; b < stretches; ++b) {
        const Eigen::Index from = b * samples / stretches * tangent.axes;
        const Eigen::Index count = (b + 1) * samples / stretches * tangent.axes - from;
        scores_.emplace_back(Eigen::VectorXd::Zero(information_.cols()));
        scores_.back()(at) =
            weight * tangent.jacobian.middleRows(from, count).transpose() * tangent.residual.segment(from, count);
    }
}

void OutputErrorUncertainty::solve() {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information_);
    const Eigen::MatrixXd& V = eigen.eigenvectors();
    Eigen::VectorXd inverse = Eigen::VectorXd::Zero(information_.cols()), open = inverse;
    for (Eigen::Index d = 0; d < inverse.size(); ++d) {
        const double strength = std::max(0.0, eigen.eigenvalues()[d]);
        const double noise = V.col(d).dot(noise_ * V.col(d));
        if (strength * kNotKnown > std::sqrt(std::max(0.0, noise)))
            inverse[d] = 1 / strength;
        else
            open[d] = kNotKnown * kNotKnown;
    }
    const Eigen::MatrixXd U = V * inverse.asDiagonal() * V.transpose();
    covariance_ = U * noise_ * U + V * open.asDiagonal() * V.transpose();
    for (Eigen::VectorXd& score : scores_) score = U * score;
}

double OutputErrorUncertainty::calcVarianceByStretches(const Eigen::VectorXd& combination) const {
    double sum = 0;
    for (const Eigen::VectorXd& score : scores_) sum += std::pow(combination.dot(score), 2);
    const auto count = static_cast<double>(scores_.size());
    return count > 1 ? sum * count / (count - 1) : 0;
}

double OutputErrorUncertainty::calcStandardError(const Eigen::VectorXd& combination) const {
    const double stationary = combination.dot(covariance_ * combination);
    return std::sqrt(std::max({0.0, stationary, calcVarianceByStretches(combination)}));
}

double OutputErrorUncertainty::calcHalfWidth(const Eigen::VectorXd& combination) const {
    constexpr double normal95 = 1.96;
    const double stationary = std::sqrt(std::max(0.0, combination.dot(covariance_ * combination)));
    const double by_stretches = std::sqrt(calcVarianceByStretches(combination));
    return std::max(normal95 * stationary, studentQuantile95(static_cast<double>(scores_.size()) - 1) * by_stretches);
}

Eigen::MatrixXd OutputErrorUncertainty::makeCovariance() const {
    const Eigen::Index size = covariance_.cols();
    Eigen::VectorXd factors = Eigen::VectorXd::Ones(size);
    for (Eigen::Index j = 0; j < size; ++j) {
        const double stationary = std::sqrt(std::max(0.0, covariance_(j, j)));
        if (stationary > 0) factors[j] = calcStandardError(Eigen::VectorXd::Unit(size, j)) / stationary;
    }
    return factors.asDiagonal() * covariance_ * factors.asDiagonal();
}

}  // namespace wems::identify
