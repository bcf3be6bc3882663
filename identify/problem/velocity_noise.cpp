#include "identify/problem/velocity_noise.hpp"

#include <algorithm>
#include <cmath>

#include "identify/motion/fourier.hpp"
#include "models/common/units.hpp"

namespace wems::identify {

namespace {

constexpr double kFrame = 2.5;            // periods of the lowest excited frequency
constexpr int kOverlap = 4;               // frames over each sample
constexpr double kOversubtraction = 2.0;  // of the noise's power, which scatters as much as it is

}  // namespace

int velocityNoiseFrame(double interval, double lowest) {
    int hop = std::max(4, static_cast<int>(std::lround(kFrame / lowest / interval / kOverlap)));
    while (Fourier(kOverlap * hop).size() != kOverlap * hop) ++hop;
    return kOverlap * hop;
}

Eigen::MatrixXd removeVelocityNoise(const Eigen::MatrixXd& velocities, int frame, double interval,
                                    const Eigen::MatrixXd& density) {
    const int length = frame, hop = length / kOverlap;
    const Fourier fourier(length);
    // Root of a Hann window, applied before and after: the squares of the overlapping frames add up to a constant.
    const Eigen::ArrayXd window =
        (kPi * (Eigen::ArrayXd::LinSpaced(length, 0, length - 1) + 0.5) / length).sin() * std::sqrt(2.0 / kOverlap);
    const double power = window.square().sum() / (2 * interval);
    const Eigen::Index samples = velocities.cols(), frames = (samples + length) / hop + 1;
    Eigen::MatrixXd result(velocities.rows(), samples);
    for (Eigen::Index row = 0; row < velocities.rows(); ++row) {
        // Frame j begins at sample (j + 1) hop − length, so that the ends too are in kOverlap frames.
        Eigen::MatrixXd stretches = Eigen::MatrixXd::Zero(frames, length);
        const auto visit = [&](const auto& action) {
            for (Eigen::Index j = 0; j < frames; ++j)
                for (Eigen::Index k = 0; k < length; ++k) {
                    const Eigen::Index sample = (j + 1) * hop - length + k;
                    if (sample >= 0 && sample < samples) action(j, k, sample);
                }
        };
        visit([&](Eigen::Index j, Eigen::Index k, Eigen::Index sample) {
            stretches(j, k) = window[k] * velocities(row, sample);
        });
        Eigen::MatrixXcd spectra = fourier.forward(stretches);
        const Eigen::Index bins = spectra.cols();
        for (Eigen::Index j = 0; j < frames; ++j) {
            const Eigen::ArrayXd squares = spectra.row(j).cwiseAbs2().transpose().array();
            for (Eigen::Index b = 0; b < bins; ++b) {
                const Eigen::Index from = std::max<Eigen::Index>(0, b - 1), to = std::min(bins - 1, b + 1);
                const double measured = squares.segment(from, to - from + 1).mean();
                const double noise = kOversubtraction * power * density(row, b);
                spectra(j, b) *= noise < measured ? 1 - noise / measured : 0.0;
            }
        }
        stretches = fourier.inverse(spectra, length);
        result.row(row).setZero();
        visit([&](Eigen::Index j, Eigen::Index k, Eigen::Index sample) {
            result(row, sample) += window[k] * stretches(j, k);
        });
    }
    return result;
}

QuietVelocities::QuietVelocities(const AxisSeries& velocities, int frame, double interval,
                                 const Eigen::MatrixXd& density)
    : noisy_(std::make_shared<Noisy>()) {
    noisy_->velocities = velocities;
    noisy_->frame = frame;
    noisy_->interval = interval;
    noisy_->density = density;
    noisy_->quiet.resize(static_cast<std::size_t>(velocities.rows()));
}

Eigen::VectorXd QuietVelocities::of(Eigen::Index axis) const {
    if (!noisy_) return added_.row(axis).transpose();
    const std::lock_guard<std::mutex> lock(noisy_->guard);
    Eigen::VectorXd& quiet = noisy_->quiet[static_cast<std::size_t>(axis)];
    if (quiet.size() == 0)
        quiet = removeVelocityNoise(noisy_->velocities.row(axis), noisy_->frame, noisy_->interval,
                                    noisy_->density.row(axis))
                    .transpose();
    return added_.size() > 0 ? (quiet + added_.row(axis).transpose()).eval() : quiet;
}

void QuietVelocities::add(const AxisSeries& velocities) {
    if (added_.size() > 0)
        added_ += velocities;
    else
        added_ = velocities;
}

}  // namespace wems::identify
