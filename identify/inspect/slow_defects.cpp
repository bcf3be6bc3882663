#include "identify/inspect/slow_defects.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "identify/motion/hum.hpp"
#include "identify/motion/noise_estimate.hpp"
#include "models/common/units.hpp"

namespace wems::identify {
namespace {

constexpr double significant = 6;      // standard deviations
constexpr double least_offset = 0.02;  // of the channel's RMS
constexpr double least_drift = 0.05;   // of the channel's RMS
constexpr double least_hum = 0.002;    // of the channel's RMS
constexpr Eigen::Index least_blocks = 12;

/// Mean over a block weighted by a Hann window: what oscillates in it counts for little.
double calcWindowedMean(const Eigen::VectorXd& signal, Eigen::Index first, Eigen::Index count) {
    double sum = 0, weights = 0;
    for (Eigen::Index i = 0; i < count; ++i) {
        const double weight =
            0.5 - 0.5 * std::cos(kTwoPi * (static_cast<double>(i) + 0.5) / static_cast<double>(count));
        sum += weight * signal[first + i];
        weights += weight;
    }
    return sum / weights;
}

std::string formatLevel(double value, const Channel& channel) {
    const auto name = parseChannelName(channel.name);
    char text[60];
    std::snprintf(text, sizeof text, "%.4g %s", value, name ? siUnit(findQuantity(*name)) : "");
    return text;
}

}  // namespace

SlowLevel findSlowLevel(const Eigen::VectorXd& signal, double interval, double lowest) {
    SlowLevel level;
    const double period = lowest > 0 ? 1 / lowest : 10 * interval;
    auto length = static_cast<Eigen::Index>(std::ceil(10 * period / interval));
    length = std::max<Eigen::Index>(length, signal.size() / 200);
    length =
        std::min(length, std::max<Eigen::Index>(signal.size() / 40, static_cast<Eigen::Index>(4 * period / interval)));
    const Eigen::Index count = length > 0 ? signal.size() / length : 0;
    if (count < least_blocks) {
        level.start_deviation = level.change_deviation = std::numeric_limits<double>::infinity();
        return level;
    }
    std::vector<double> means, slopes;
    for (Eigen::Index k = 0; k < count; ++k) means.push_back(calcWindowedMean(signal, k * length, length));
    for (std::size_t i = 0; i < means.size(); ++i)
        for (std::size_t j = i + 1; j < means.size(); ++j)
            slopes.push_back((means[j] - means[i]) / static_cast<double>(j - i));
    const double slope = median(std::move(slopes));
    std::vector<double> intercepts;
    for (std::size_t i = 0; i < means.size(); ++i) intercepts.push_back(means[i] - slope * static_cast<double>(i));
    level.start = median(intercepts);
    level.change = slope * static_cast<double>(count - 1);
    const double scatter = medianDeviation(intercepts, level.start);
    const auto n = static_cast<double>(count);
    level.start_deviation = 2 * scatter / std::sqrt(n);
    level.change_deviation = scatter * std::sqrt(12 / n);
    return level;
}

namespace {

/// Hum that is worth telling of.
Hum findNotableHum(const Eigen::VectorXd& signal, double interval, double noise, const SweptFrequency& swept) {
    const Hum hum = findHum(signal, interval);
    if (!(hum.frequency > 0)) return {};
    if (isDrivenAt(swept, hum.frequency, static_cast<double>(signal.size()) * interval)) return {};
    const double rms = std::sqrt((signal.array() - signal.mean()).square().mean());
    // Half the noise that a block leaves at one frequency, whatever the statistics say.
    const double blind = noise > 0 ? noise / std::sqrt(hum.block / interval) : 0;
    return std::abs(hum.amplitude) < std::max(least_hum * rms, blind) ? Hum() : hum;
}

}  // namespace

std::vector<Finding> findSlowDefects(const Channel& channel, double interval, double noise, const SweptFrequency& swept,
                                     const std::vector<double>& time, long row) {
    std::vector<Finding> findings;
    const Eigen::VectorXd signal = Eigen::Map<const Eigen::VectorXd>(channel.values.data(), channel.values.size());
    const double rms = std::sqrt((signal.array() - signal.mean()).square().mean());
    if (!(rms > 0)) return findings;
    const auto add = [&](FindingKind kind, const std::string& what) {
        findings.push_back({kind, channel.name, row, time.front(), channel.name + ": " + what});
    };
    // Without an excited band there is no telling what is slow.
    SlowLevel level;
    if (swept.lowest > 0) level = findSlowLevel(signal, interval, swept.lowest);
    if (std::abs(level.start) > std::max(significant * level.start_deviation, least_offset * rms))
        add(FindingKind::offset, "offset of " + formatLevel(level.start, channel) + " at the start");
    if (std::abs(level.change) > std::max(significant * level.change_deviation, least_drift * rms))
        add(FindingKind::drift, "drifts by " + formatLevel(level.change, channel) + " over the recording");
    const Hum hum = findNotableHum(signal, interval, noise, swept);
    if (hum.frequency > 0) {
        char text[80];
        std::snprintf(text, sizeof text, "hum of the mains at %.2f Hz, amplitude ", hum.frequency);
        add(FindingKind::hum, text + formatLevel(std::abs(hum.amplitude), channel));
    }
    return findings;
}

}  // namespace wems::identify
