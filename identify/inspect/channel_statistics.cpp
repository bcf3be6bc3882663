#include "identify/inspect/channel_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/motion/noise_estimate.hpp"

namespace wems::identify {
namespace {

constexpr double kTailPower = 0.005;  // of all, on each side of the band that is reported: 99 % lie within
constexpr int kSegment = 16384;       // samples of a stretch whose spectrum is averaged

void findBand(ChannelStatistics& statistics) {
    const Spectrum& spectrum = statistics.spectrum;
    const double total = spectrum.density.sum();
    if (!(total > 0)) return;
    double sum = 0;
    statistics.band_from = -1;
    for (Eigen::Index i = 0; i < spectrum.density.size(); ++i) {
        sum += spectrum.density[i];
        if (statistics.band_from < 0 && sum > kTailPower * total) statistics.band_from = spectrum.frequency[i];
        statistics.band_to = spectrum.frequency[i];
        if (sum > (1 - kTailPower) * total) return;
    }
}

}  // namespace

void ChannelLevels::addMoments(const Eigen::Ref<const Eigen::VectorXd>& signal) {
    if (signal.size() == 0) return;
    const auto count = static_cast<double>(signal.size());
    const double mean = signal.mean(), away = mean - mean_;
    squares_ += (signal.array() - mean).square().sum() + away * away * count_ * count / (count_ + count);
    mean_ += away * count / (count_ + count);
    count_ += count;
}

void ChannelLevels::add(const Channel& channel, double interval) {
    const Eigen::Map<const Eigen::VectorXd> signal(channel.values.data(), channel.values.size());
    const bool is_first = count_ == 0;
    name_ = channel.name;
    addMoments(signal.tail(signal.size() - (is_first ? 0 : 1)));
    const auto count = static_cast<double>(signal.size());
    lowest_ = is_first ? signal.minCoeff() : std::min(lowest_, signal.minCoeff());
    highest_ = is_first ? signal.maxCoeff() : std::max(highest_, signal.maxCoeff());
    noise_power_ += count * std::pow(estimateNoiseFromSignal(signal), 2);
    noise_samples_ += count;
    if (!(interval > 0)) return;
    Spectrum spectrum = calcSpectrum(signal, interval, kSegment);
    if (is_first) {
        spectrum_ = std::move(spectrum);
        spectrum_.density *= count;
    } else if (spectrum.density.size() == spectrum_.density.size()) {
        spectrum_.density += count * spectrum.density;
    } else {
        return;  // a block too short for the others' resolution
    }
    spectrum_samples_ += count;
}

ChannelStatistics ChannelLevels::finish() const {
    ChannelStatistics statistics;
    statistics.name = name_;
    const auto name = parseChannelName(name_);
    statistics.unit = name ? siUnit(findQuantity(*name)) : "";
    statistics.mean = mean_;
    statistics.lowest = lowest_;
    statistics.highest = highest_;
    statistics.rms = std::sqrt(squares_ / count_);
    statistics.noise = std::sqrt(noise_power_ / noise_samples_);
    statistics.signal_to_noise = statistics.noise > 0 ? 20 * std::log10(statistics.rms / statistics.noise)
                                                      : std::numeric_limits<double>::infinity();
    if (spectrum_samples_ > 0) {
        statistics.spectrum = spectrum_;
        statistics.spectrum.density /= spectrum_samples_;
        findBand(statistics);
    }
    return statistics;
}

}  // namespace wems::identify
