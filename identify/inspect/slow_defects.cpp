#include "identify/inspect/slow_defects.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <limits>

#include "identify/motion/noise_estimate.hpp"
#include "models/common/units.hpp"

namespace wems::identify {
namespace {

constexpr double normal_mad = 1.4826;    // standard deviation over median absolute deviation
constexpr double significant = 6;        // standard deviations
constexpr double least_offset = 0.02;    // of the channel's RMS
constexpr double least_drift = 0.05;     // of the channel's RMS
constexpr double least_hum = 0.002;      // of the channel's RMS
constexpr double mains_tolerance = 0.1;  // Hz
constexpr double hum_block = 1.0;        // s
constexpr Eigen::Index least_blocks = 12;

double medianDeviation(const std::vector<double>& values, double centre) {
    std::vector<double> deviations;
    deviations.reserve(values.size());
    for (const double value : values) deviations.push_back(std::abs(value - centre));
    return normal_mad * median(std::move(deviations));
}

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

/// Component at `frequency` of each Hann block, phases counted from the start of the recording.
std::vector<std::complex<double>> calcComponents(const Eigen::VectorXd& signal, double interval, double frequency,
                                                 std::vector<double>& centres) {
    const auto length = static_cast<Eigen::Index>(std::lround(hum_block / interval));
    std::vector<std::complex<double>> components;
    centres.clear();
    const std::complex<double> turn = std::polar(1.0, -kTwoPi * frequency * interval);
    for (Eigen::Index first = 0; first + length <= signal.size(); first += std::max<Eigen::Index>(1, length / 2)) {
        const double mean = calcWindowedMean(signal, first, length);
        std::complex<double> sum = 0,
                             phase = std::polar(1.0, -kTwoPi * frequency * interval * static_cast<double>(first));
        double weights = 0;
        for (Eigen::Index i = 0; i < length; ++i) {
            const double weight =
                0.5 - 0.5 * std::cos(kTwoPi * (static_cast<double>(i) + 0.5) / static_cast<double>(length));
            sum += weight * (signal[first + i] - mean) * phase;
            weights += weight;
            phase *= turn;
        }
        components.push_back(2.0 * sum / weights);
        centres.push_back(interval * (static_cast<double>(first) + 0.5 * static_cast<double>(length)));
    }
    return components;
}

/// Amplitude of the median component if it is significant, otherwise 0.
double findCoherent(const std::vector<std::complex<double>>& components, const std::vector<double>& centres,
                    double shift) {
    std::vector<double> real, imaginary;
    for (std::size_t i = 0; i < components.size(); ++i) {
        const auto turned = components[i] * std::polar(1.0, -kTwoPi * shift * centres[i]);
        real.push_back(turned.real());
        imaginary.push_back(turned.imag());
    }
    const double x = median(real), y = median(imaginary);
    const double scatter = std::hypot(medianDeviation(real, x), medianDeviation(imaginary, y)) / std::sqrt(2.0);
    // Blocks overlap by half, and the median costs a factor of 1.25.
    const double deviation = 1.25 * scatter / std::sqrt(0.5 * static_cast<double>(components.size()));
    const double amplitude = std::hypot(x, y);
    return amplitude > significant * deviation ? amplitude : 0;
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

Hum findHum(const Eigen::VectorXd& signal, double interval, double noise, const SweptFrequency& swept) {
    Hum best;
    const auto samples = static_cast<double>(signal.size());
    if (samples * interval < 4 * hum_block) return best;
    const double duration = samples * interval;
    for (const double mains : {50.0, 60.0}) {
        if (mains + 1 > 0.5 / interval) continue;
        // A dwell there is no hum.
        if (swept.is_sine && std::abs(swept.highest - mains) < 1 && std::abs(swept.lowest - mains) < 1) continue;
        std::vector<double> centres;
        const auto components = calcComponents(signal, interval, mains, centres);
        const double step = std::min(0.05, 0.25 / duration);
        for (double shift = -mains_tolerance; shift <= mains_tolerance; shift += step) {
            const double amplitude = findCoherent(components, centres, shift);
            if (amplitude > best.amplitude) best = {mains + shift, amplitude};
        }
    }
    const double rms = std::sqrt((signal.array() - signal.mean()).square().mean());
    // Half the noise that a block of one second leaves at one frequency, whatever the statistics say.
    const double blind = noise > 0 ? noise / std::sqrt(hum_block / interval) : 0;
    if (best.amplitude < std::max(least_hum * rms, blind)) return {};
    return best;
}

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
    const Hum hum = findHum(signal, interval, noise, swept);
    if (hum.frequency > 0) {
        char text[80];
        std::snprintf(text, sizeof text, "hum of the mains at %.2f Hz, amplitude ", hum.frequency);
        add(FindingKind::hum, text + formatLevel(hum.amplitude, channel));
    }
    return findings;
}

}  // namespace wems::identify
