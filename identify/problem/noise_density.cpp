#include "identify/problem/noise_density.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "identify/problem/fourier.hpp"
#include "models/common/units.hpp"

namespace wems::identify {

namespace {

constexpr double kLowerQuartile = -0.6744897501960817;  // of a standard normal variable

}  // namespace

double calcQuartileRatio(double freedom) {
    const double variance = 2 / (9 * freedom);
    const double root = 1 - variance + kLowerQuartile * std::sqrt(variance);
    return root * root * root;
}

NoiseDensity::NoiseDensity(double variance) : resolution_(1), variance_{variance} {}

NoiseDensity::NoiseDensity(const Eigen::MatrixXd& residuals, int freedom, double interval, double resolution,
                           double least) {
    const auto samples = residuals.cols();
    const auto length =
        std::clamp<Eigen::Index>(static_cast<Eigen::Index>(std::ceil(1 / (resolution * interval))), 16, samples);
    const Fourier fourier(static_cast<int>(length));
    resolution_ = 1 / (fourier.size() * interval);
    Eigen::RowVectorXd window(length);
    // Hann's window squared, whose side lobes fall by 30 dB an octave: with Hann's own (18 dB) a sweep 60 dB above the
    // noise leaks twice as much as it at 20 Hz.
    for (Eigen::Index k = 0; k < length; ++k)
        window[k] = std::pow(std::sin(kPi * (static_cast<double>(k) + 0.5) / static_cast<double>(length)), 4);
    const double gain = window.squaredNorm();
    const Eigen::Index hop = std::max<Eigen::Index>(1, length / 3);
    std::vector<std::vector<double>> power(fourier.binCount());
    for (Eigen::Index first = 0; first + length <= samples; first += hop) {
        const Eigen::MatrixXcd spectra = fourier.forward(residuals.middleCols(first, length) * window.asDiagonal());
        for (Eigen::Index b = 0; b < spectra.cols(); ++b)
            power[b].push_back(spectra.col(b).squaredNorm() / (gain * freedom));
    }
    const double ratio = calcQuartileRatio(2.0 * freedom);
    for (auto& values : power) {
        const auto quartile = values.begin() + static_cast<long>(values.size() / 4);
        std::nth_element(values.begin(), quartile, values.end());
        variance_.push_back(std::max(least, *quartile / ratio));
    }
}

double NoiseDensity::at(double frequency) const {
    const double place = std::clamp(frequency / resolution_, 0.0, static_cast<double>(variance_.size() - 1));
    const auto below = static_cast<std::size_t>(place);
    const auto above = std::min(below + 1, variance_.size() - 1);
    const double u = place - static_cast<double>(below);
    return (1 - u) * variance_[below] + u * variance_[above];
}

double NoiseDensity::medianBetween(double from, double to) const {
    std::vector<double> values;
    for (std::size_t k = 0; k < variance_.size(); ++k) {
        const double frequency = static_cast<double>(k) * resolution_;
        if (frequency >= from && frequency <= to) values.push_back(variance_[k]);
    }
    if (values.empty()) return at(to);
    const auto middle = values.begin() + static_cast<long>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

void NoiseDensity::levelBelow(double frequency) {
    const auto first = std::min(static_cast<std::size_t>(std::ceil(frequency / resolution_)), variance_.size() - 1);
    std::fill_n(variance_.begin(), first, variance_[first]);
}

void NoiseDensity::scale(double factor) {
    for (double& variance : variance_) variance *= factor;
}

double NoiseDensity::variance() const {
    return std::accumulate(variance_.begin(), variance_.end(), 0.0) / static_cast<double>(variance_.size());
}

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

}  // namespace wems::identify
