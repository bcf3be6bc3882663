#include "identify/inspect/channel_statistics.hpp"

#include <cmath>
#include <limits>

#include "identify/motion/noise_estimate.hpp"
#include "identify/motion/spectrum.hpp"

namespace wems::identify {
namespace {

constexpr double tail_power = 0.005;  // on each side of the band

void findBand(const Eigen::VectorXd& signal, double interval, ChannelStatistics& statistics) {
    const Spectrum spectrum = calcSpectrum(signal, interval, 16384);
    const double total = spectrum.density.sum();
    if (!(total > 0)) return;
    double sum = 0;
    statistics.band_from = -1;
    for (Eigen::Index i = 0; i < spectrum.density.size(); ++i) {
        sum += spectrum.density[i];
        if (statistics.band_from < 0 && sum > tail_power * total) statistics.band_from = spectrum.frequency[i];
        statistics.band_to = spectrum.frequency[i];
        if (sum > (1 - tail_power) * total) return;
    }
}

}  // namespace

ChannelStatistics calcStatistics(const Channel& channel, double interval) {
    ChannelStatistics statistics;
    statistics.name = channel.name;
    const auto name = parseChannelName(channel.name);
    statistics.unit = name ? siUnit(findQuantity(*name)) : "";
    const Eigen::Map<const Eigen::VectorXd> signal(channel.values.data(),
                                                   static_cast<Eigen::Index>(channel.values.size()));
    statistics.mean = signal.mean();
    statistics.lowest = signal.minCoeff();
    statistics.highest = signal.maxCoeff();
    statistics.rms = std::sqrt((signal.array() - statistics.mean).square().mean());
    statistics.noise = estimateNoiseFromSignal(signal);
    statistics.signal_to_noise = statistics.noise > 0 ? 20 * std::log10(statistics.rms / statistics.noise)
                                                      : std::numeric_limits<double>::infinity();
    if (interval > 0) findBand(signal, interval, statistics);
    return statistics;
}

}  // namespace wems::identify
