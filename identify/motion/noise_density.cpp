#include "identify/motion/noise_density.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "identify/motion/fourier.hpp"
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
    // Of one stretch there is no quartile: it is its own mean.
    const double ratio = power.front().size() > 1 ? calcQuartileRatio(2.0 * freedom) : 1.0;
    for (auto& values : power) {
        const auto quartile = values.begin() + static_cast<long>(values.size() / 4);
        std::nth_element(values.begin(), quartile, values.end());
        variance_.push_back(std::max(least, *quartile / ratio));
    }
}

namespace {

double interpolate(const std::vector<double>& values, double place) {
    place = std::clamp(place, 0.0, static_cast<double>(values.size() - 1));
    const auto below = static_cast<std::size_t>(place);
    const auto above = std::min(below + 1, values.size() - 1);
    const double u = place - static_cast<double>(below);
    return (1 - u) * values[below] + u * values[above];
}

}  // namespace

double NoiseDensity::at(double frequency) const {
    if (!finer_.empty() && frequency < resolution_) return interpolate(finer_, frequency / finer_resolution_);
    return interpolate(variance_, frequency / resolution_);
}

void NoiseDensity::refine(const NoiseDensity& finer) {
    finer_resolution_ = finer.resolution_;
    const auto count = static_cast<std::size_t>(std::ceil(resolution_ / finer_resolution_)) + 1;
    finer_.assign(finer.variance_.begin(),
                  finer.variance_.begin() + static_cast<long>(std::min(count, finer.variance_.size())));
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

void NoiseDensity::limitBelow(double frequency) {
    const auto first = std::min(static_cast<std::size_t>(std::ceil(frequency / resolution_)), variance_.size() - 1);
    const double pink = variance_[first] * static_cast<double>(first) * resolution_;
    const auto limit = [&](std::vector<double>& variances, double resolution) {
        for (std::size_t k = 0; k < variances.size(); ++k) {
            const double f = std::max(0.5, static_cast<double>(k)) * resolution;
            if (f < static_cast<double>(first) * resolution_) variances[k] = std::min(variances[k], pink / f);
        }
    };
    limit(variance_, resolution_);
    limit(finer_, finer_resolution_);
}

void NoiseDensity::scale(double factor) {
    for (double& variance : variance_) variance *= factor;
    for (double& variance : finer_) variance *= factor;
}

double NoiseDensity::variance() const {
    return std::accumulate(variance_.begin(), variance_.end(), 0.0) / static_cast<double>(variance_.size());
}

namespace {

constexpr int kStretchesOfRun = 8;          // of a run: a quartile of their overlapping ones scatters by a fifth
constexpr Eigen::Index kChannelsShown = 6;  // that are transformed: all have the same noise
constexpr std::size_t kLostLines = 3;       // of a spectrum to the mean that is taken off: half the window's main lobe
constexpr std::size_t kShownLines = 6;      // from there on, that show how noise goes on below: their mean scatters by
                                            // 0.4 over the root of the freedom

/// The mean that was taken off, and the lines that go with it, as 1/f noise above the white has them that is as large
/// in the next lines.
NoiseDensity continueToZero(const NoiseDensity& whole, double mean, double white) {
    std::vector<double> variances = whole.variances();
    if (variances.size() < kLostLines + kShownLines) return whole;
    double pink = 0;  // times the distance of two lines
    for (std::size_t k = kLostLines; k < kLostLines + kShownLines; ++k)
        pink += static_cast<double>(k) * (variances[k] - white) / kShownLines;
    variances[0] = mean;
    for (std::size_t k = 1; k < kLostLines; ++k) variances[k] = white + std::max(0.0, pink) / static_cast<double>(k);
    return {whole.resolution(), std::move(variances)};
}

}  // namespace

NoiseDensity estimateNoiseDensity(const Eigen::MatrixXd& residuals, int redundancy, double white, double interval) {
    if (redundancy < 1) return NoiseDensity(std::isfinite(white) ? white * white : 0.0);
    const Eigen::Index every = (residuals.rows() + kChannelsShown - 1) / kChannelsShown,
                       count = (residuals.rows() + every - 1) / every;
    // Of so many channels the fit leaves that many values.
    const double left =
        static_cast<double>(redundancy) * static_cast<double>(count) / static_cast<double>(residuals.rows());
    const int freedom = std::max(1, static_cast<int>(left));
    const Eigen::MatrixXd some = std::sqrt(freedom / left) * residuals(Eigen::seqN(0, count, every), Eigen::all);
    const double length = static_cast<double>(residuals.cols()) * interval;
    NoiseDensity density(some, freedom, interval, kStretchesOfRun / length, 0.0);
    const Eigen::VectorXd means = some.rowwise().mean();
    const NoiseDensity whole(some.colwise() - means, freedom, interval, 1 / length, 0.0);
    density.refine(continueToZero(whole, means.squaredNorm() * static_cast<double>(some.cols()) / freedom,
                                  density.medianBetween(0.25 / interval, 0.5 / interval)));
    return density;
}

}  // namespace wems::identify
