#include "identify/motion/hum.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "identify/motion/noise_estimate.hpp"
#include "models/common/units.hpp"

namespace wems::identify {
namespace {

// Standard deviations of each part: noise alone exceeds it with exp(−18), 1.5e-8, at each of some hundred frequencies
// and channels.
constexpr double kDeviationsOfHum = 6;
constexpr double kNear = 2.5;          // standard deviations from the median: 96 % of normal components
constexpr double kTolerance = 0.1;     // Hz, of the mains
constexpr double kLongestBlock = 1.0;  // s
constexpr double kBlocksOfAll = 8;     // of a recording, at least
constexpr double kPeriodsOfBlock = 4;  // of the mains in a block: its window then tells the line from what is slow

/// Component at `frequency` of each Hann block, phases counted from the start of the recording.
std::vector<std::complex<double>> calcComponents(const Eigen::VectorXd& signal, double interval, double block,
                                                 double frequency, std::vector<double>& centres) {
    const auto length = static_cast<Eigen::Index>(std::lround(block / interval));
    Eigen::VectorXd window(length);
    // Hann's squared: a sweep that is elsewhere leaks less.
    for (Eigen::Index i = 0; i < length; ++i)
        window[i] = std::pow(std::sin(kPi * (static_cast<double>(i) + 0.5) / static_cast<double>(length)), 4);
    window /= window.sum();
    std::vector<std::complex<double>> components;
    centres.clear();
    const std::complex<double> turn = std::polar(1.0, -kTwoPi * frequency * interval);
    for (Eigen::Index first = 0; first + length <= signal.size(); first += std::max<Eigen::Index>(1, length / 2)) {
        const double mean = window.dot(signal.segment(first, length));
        std::complex<double> sum = 0,
                             phase = std::polar(1.0, -kTwoPi * frequency * interval * static_cast<double>(first));
        for (Eigen::Index i = 0; i < length; ++i) {
            sum += window[i] * (signal[first + i] - mean) * phase;
            phase *= turn;
        }
        components.push_back(2.0 * sum);
        centres.push_back(interval * (static_cast<double>(first) + 0.5 * static_cast<double>(length)));
    }
    return components;
}

struct Coherent {
    std::complex<double> amplitude = 0;
    double deviation = 0;

    bool isSignificant() const { return std::abs(amplitude) > kDeviationsOfHum * deviation; }
};

/// The component that most blocks have, `shift` Hz beside.
Coherent findCoherent(const std::vector<std::complex<double>>& components, const std::vector<double>& centres,
                      double shift) {
    std::vector<double> real, imaginary;
    for (std::size_t i = 0; i < components.size(); ++i) {
        const auto turned = components[i] * std::polar(1.0, -kTwoPi * shift * centres[i]);
        real.push_back(turned.real());
        imaginary.push_back(turned.imag());
    }
    const double x = median(real), y = median(imaginary);
    const double scatter = std::hypot(medianDeviation(real, x), medianDeviation(imaginary, y)) / std::sqrt(2.0);
    // The mean of what is near the median: blocks that a sweep passes would draw the median to one side.
    std::complex<double> sum = 0;
    double count = 0;
    for (std::size_t i = 0; i < real.size(); ++i) {
        if (std::hypot(real[i] - x, imaginary[i] - y) > kNear * scatter) continue;
        sum += std::complex<double>(real[i], imaginary[i]);
        ++count;
    }
    if (count < 2) return {};
    // Blocks overlap by half.
    return {sum / count, scatter / std::sqrt(0.5 * count)};
}

}  // namespace

Hum findHum(const Eigen::VectorXd& signal, double interval) {
    Hum best;
    const double duration = static_cast<double>(signal.size()) * interval;
    const double block = std::min(kLongestBlock, duration / kBlocksOfAll);
    for (const double mains : {50.0, 60.0}) {
        if (mains + 1 > 0.5 / interval || block * mains < kPeriodsOfBlock) continue;
        std::vector<double> centres;
        const auto components = calcComponents(signal, interval, block, mains, centres);
        const double step = std::min(0.05, 0.25 / duration);
        // The mains keep their frequency to a tolerance of two standard deviations. A short recording says nothing of
        // it: the largest component would be that of a frequency beside.
        const double deviation = findCoherent(components, centres, 0).deviation;
        Hum own;
        double highest = -1;
        for (double shift = -kTolerance; shift <= kTolerance + 0.5 * step; shift += step) {
            const Coherent coherent = findCoherent(components, centres, shift);
            const double score = std::norm(coherent.amplitude / deviation) - std::pow(2 * shift / kTolerance, 2);
            if (!coherent.isSignificant() || !(score > highest)) continue;
            highest = score;
            own = {mains + shift, coherent.amplitude, block};
        }
        if (std::abs(own.amplitude) > std::abs(best.amplitude)) best = own;
    }
    return best;
}

bool isDrivenAt(const SweptFrequency& swept, double frequency, double duration) {
    const double resolution = std::max(1.0, 2 / duration);
    const auto isNear = [&](double other) { return std::abs(other - frequency) < resolution; };
    return (swept.is_sine && isNear(swept.highest) && isNear(swept.lowest)) ||
           std::any_of(swept.tones.begin(), swept.tones.end(), isNear);
}

void removeDriveHum(Recording& uniform, std::vector<std::string>& notes) {
    const double interval = uniform.sampleInterval();
    std::optional<SweptFrequency> swept;
    for (Channel& channel : uniform.channels) {
        const auto name = parseChannelName(channel.name);
        if (!name || (name->part != Part::load && name->part != Part::base)) continue;
        const auto samples = static_cast<Eigen::Index>(channel.values.size());
        Eigen::Map<Eigen::VectorXd> values(channel.values.data(), samples);
        const Hum hum = findHum(values, interval);
        if (!(hum.frequency > 0)) continue;
        if (!swept) swept = findSweptFrequency(uniform);
        if (isDrivenAt(*swept, hum.frequency, static_cast<double>(samples) * interval)) continue;
        for (Eigen::Index k = 0; k < samples; ++k)
            values[k] -=
                (hum.amplitude * std::polar(1.0, kTwoPi * hum.frequency * interval * static_cast<double>(k))).real();
        char text[160];
        std::snprintf(text, sizeof text, "hum of the mains at %.2f Hz, amplitude %.4g %s, is taken off", hum.frequency,
                      std::abs(hum.amplitude), siUnit(findQuantity(*name)));
        notes.push_back(channel.name + ": " + text);
    }
}

}  // namespace wems::identify
