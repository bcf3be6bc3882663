#include "identify/problem/noise_density.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "identify/problem/fourier.hpp"
#include "models/pi.hpp"

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

void NoiseDensity::scale(double factor) {
    for (double& variance : variance_) variance *= factor;
}

double NoiseDensity::variance() const {
    return std::accumulate(variance_.begin(), variance_.end(), 0.0) / static_cast<double>(variance_.size());
}

}  // namespace wems::identify
