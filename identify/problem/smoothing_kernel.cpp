#include "identify/problem/smoothing_kernel.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "identify/motion/fourier.hpp"
#include "models/common/units.hpp"

namespace wems::identify {

namespace {

using Matrix12 = Eigen::Matrix<double, 12, 12>;

constexpr double kFrom = 0.4, kTo = 0.49;  // of the sampling rate: where folding is seen
constexpr double kFolded = 0.06;           // of the power there: near zero frequency

}  // namespace

Eigen::Matrix<double, 12, 12> calcAliasing(const RunMotion& run) {
    Eigen::MatrixXd acceleration = Eigen::MatrixXd::Zero(12, run.mobile.a.cols());
    Matrix12 noise = Matrix12::Zero();
    bool measured = false;
    const auto fill = [&](const PartMotion& part, Eigen::Index row) {
        if (!part.acceleration_measured) return;
        acceleration.middleRows(row, 3) = part.a;
        acceleration.middleRows(row + 3, 3) = part.alpha;
        noise.block<6, 6>(row, row) =
            part.acceleration_density.medianBetween(kFrom / run.interval, kTo / run.interval) *
            part.acceleration_covariance;
        measured = true;
    };
    fill(run.mobile, 0);
    fill(run.fixed, 6);
    if (!measured) return Matrix12::Zero();
    const Fourier fourier(static_cast<int>(acceleration.cols()));
    const auto first = static_cast<Eigen::Index>(kFrom * fourier.size()),
               last = static_cast<Eigen::Index>(kTo * fourier.size());
    const Eigen::MatrixXcd seen = fourier.forward(acceleration).middleCols(first, last - first);
    const double count = static_cast<double>(seen.cols()) * static_cast<double>(acceleration.cols());
    // What noise leaves by chance is no covariance: without its negative parts.
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> parts((seen * seen.adjoint()).real() / count - noise);
    return kFolded * parts.eigenvectors() * parts.eigenvalues().cwiseMax(0.0).asDiagonal() *
           parts.eigenvectors().transpose();
}

namespace {

/// Transition band times length of the kernel: the window's main lobe.
constexpr double kLobe = 8.0;
// Sampling folds what h'' holds beyond the rate into the band. Where the transition ends at the Nyquist frequency the
// second derivative is wrong by 3.4e-4 with the fourth power, by 1.2e-6 with the sixth, whose main lobe is 8.
constexpr int kWindowPower = 6;

/// Windowed sinc as a continuous function of time, so that it can be differentiated.
double calcKernel(double t, double cutoff, double half_length) {
    const double u = t / half_length;
    if (std::abs(u) >= 1) return 0;
    const double x = kTwoPi * cutoff * t;
    const double sinc = std::abs(x) < 1e-8 ? 1.0 : std::sin(x) / x;
    const double c = std::cos(0.5 * kPi * u);
    return 2 * cutoff * sinc * std::pow(c, kWindowPower);
}

}  // namespace

SmoothingKernel::SmoothingKernel(double interval, double pass, double stop) {
    half_width_ = static_cast<int>(std::ceil(0.5 * kLobe / ((stop - pass) * interval)));
    const double half_length = half_width_ * interval;
    const double cutoff = 0.5 * (pass + stop);
    const int count = 2 * half_width_ + 1;
    for (auto& weights : weights_) weights.resize(count);
    const double d = 1e-3 * interval;
    for (int k = 0; k < count; ++k) {
        const double t = (k - half_width_) * interval;
        const double before = calcKernel(t - d, cutoff, half_length), at = calcKernel(t, cutoff, half_length),
                     after = calcKernel(t + d, cutoff, half_length);
        weights_[0][k] = at;
        weights_[1][k] = -(after - before) / (2 * d);  // correlation: (h * x)' = ∫ h'(t − s) x(s), odd in t − s
        weights_[2][k] = (after - 2 * at + before) / (d * d);
    }
    // Exact on constants, ramps and parabolas, which sampling alone does not quite give.
    const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(count, -half_width_ * interval, half_width_ * interval);
    weights_[0] /= weights_[0].sum();
    weights_[1] /= weights_[1].dot(t);
    weights_[2].array() -= weights_[2].mean();
    weights_[2] /= 0.5 * weights_[2].dot(t.cwiseAbs2());
}

namespace {

/// A row with its first and last value held for so many samples beyond its ends.
Eigen::VectorXd extend(const Eigen::Ref<const Eigen::MatrixXd>& rows, Eigen::Index row, Eigen::Index beyond) {
    const Eigen::Index samples = rows.cols();
    Eigen::VectorXd held(samples + 2 * beyond);
    held.head(beyond).setConstant(rows(row, 0));
    held.segment(beyond, samples) = rows.row(row).transpose();
    held.tail(beyond).setConstant(rows(row, samples - 1));
    return held;
}

/// Sums of weights times values, as many, each a step further on than the one before.
Eigen::RowVectorXd correlate(const Eigen::VectorXd& weights, const Eigen::Ref<const Eigen::VectorXd>& values,
                             Eigen::Index step, Eigen::Index count) {
    constexpr int kAtOnce = 16;  // sums that stay in registers, so that a weight is read once for all of them
    Eigen::RowVectorXd sums(count);
    const Eigen::Index together = step == 1 ? count - count % kAtOnce : 0;
    for (Eigen::Index k = 0; k < together; k += kAtOnce) {
        Eigen::Matrix<double, kAtOnce, 1> sum = Eigen::Matrix<double, kAtOnce, 1>::Zero();
        for (Eigen::Index j = 0; j < weights.size(); ++j) sum += weights[j] * values.segment<kAtOnce>(k + j);
        sums.segment<kAtOnce>(k) = sum.transpose();
    }
    for (Eigen::Index k = together; k < count; ++k) sums[k] = weights.dot(values.segment(k * step, weights.size()));
    return sums;
}

}  // namespace

Eigen::MatrixXd SmoothingKernel::apply(const Eigen::Ref<const Eigen::MatrixXd>& rows, int derivative, int step) const {
    const auto& weights = weights_[derivative];
    Eigen::MatrixXd result(rows.rows(), (rows.cols() + step - 1) / step);
    for (Eigen::Index row = 0; row < rows.rows(); ++row) {
        const Eigen::VectorXd held = extend(rows, row, half_width_);
        result.row(row) = correlate(weights, held, step, result.cols());
    }
    return result;
}

Eigen::MatrixXd SmoothingKernel::applyBetween(const Eigen::Ref<const Eigen::MatrixXd>& rows, int derivative,
                                              int refinement) const {
    const auto& weights = weights_[derivative];
    const Eigen::Index samples = rows.cols(), all = weights.size(), fine = refinement;
    const Eigen::Index beyond = half_width_ / fine + 1;
    Eigen::MatrixXd result(rows.rows(), (samples - 1) * fine + 1);
    std::vector<Eigen::VectorXd> held;
    for (Eigen::Index row = 0; row < rows.rows(); ++row) held.push_back(extend(rows, row, beyond));
    for (Eigen::Index phase = 0; phase < fine; ++phase) {
        // Weights that meet samples at this place within an interval; each phase alone is exact on constants.
        const Eigen::Index skipped = (half_width_ + fine - phase) % fine, count = (all - 1 - skipped) / fine + 1;
        Eigen::VectorXd own(count);
        for (Eigen::Index j = 0; j < count; ++j) own[j] = static_cast<double>(fine) * weights[skipped + j * fine];
        if (derivative == 0) own /= own.sum();
        if (derivative > 0) own.array() -= own.mean();
        const Eigen::Index first = (phase - half_width_ + skipped) / fine + beyond,
                           places = (result.cols() - phase + fine - 1) / fine;
        for (Eigen::Index row = 0; row < rows.rows(); ++row)
            result(row, Eigen::seqN(phase, places, fine)) =
                correlate(own, held[row].segment(first, places + count - 1), 1, places);
    }
    return result;
}

double SmoothingKernel::calcResponse(double frequency) const {
    const Eigen::VectorXd& weights = weights_[0];
    double sum = weights[half_width_];
    for (int k = 1; k <= half_width_; ++k) sum += 2 * weights[half_width_ + k] * std::cos(kTwoPi * frequency * k);
    return sum;
}

}  // namespace wems::identify
