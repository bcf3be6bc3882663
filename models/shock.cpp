#include "models/shock.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "models/common/format_number.hpp"
#include "models/common/text_file.hpp"
#include "models/common/units.hpp"

namespace wems {

ShockResponse calcShockResponse(const Eigen::VectorXd& acceleration, double interval,
                                const std::vector<double>& frequency, double quality) {
    const Eigen::Index count = frequency.size();
    ShockResponse response;
    response.frequency = frequency;
    response.positive.resize(count);
    response.negative.resize(count);
    const double zeta = 1 / (2 * quality);
    for (Eigen::Index i = 0; i < count; ++i) {
        const double f = frequency[i];
        const double omega = kTwoPi * f, damped = omega * std::sqrt(1 - zeta * zeta);
        const double E = std::exp(-zeta * omega * interval), K = damped * interval;
        const double C = E * std::cos(K), S = E * std::sin(K) / K;
        const double b0 = 1 - S, b1 = 2 * (S - C), b2 = E * E - S, a1 = -2 * C, a2 = E * E;
        const auto after = static_cast<Eigen::Index>(std::ceil(1 / (f * interval)));
        double x1 = 0, x2 = 0, y1 = 0, y2 = 0, highest = 0, lowest = 0;
        for (Eigen::Index k = 0; k < acceleration.size() + after; ++k) {
            const double x = k < acceleration.size() ? acceleration[k] : 0;
            const double y = b0 * x + b1 * x1 + b2 * x2 - a1 * y1 - a2 * y2;
            highest = std::max(highest, y);
            lowest = std::min(lowest, y);
            x2 = x1;
            x1 = x;
            y2 = y1;
            y1 = y;
        }
        response.positive[i] = highest;
        response.negative[i] = -lowest;
    }
    response.maximax = response.positive.cwiseMax(response.negative);
    return response;
}

std::vector<double> makeOctaves(double from, double to, int per_octave) {
    std::vector<double> frequency;
    for (int k = 0;; ++k) {
        const double f = from * std::exp2(static_cast<double>(k) / per_octave);
        if (f > to * (1 + 1e-9)) return frequency;
        frequency.push_back(f);
    }
}

namespace {

constexpr int kWaveletsPerOctave = 6, kLooksPerOctave = 12;
constexpr int kFewestHalfCycles = 7, kMostHalfCycles = 31;
constexpr double kLongest = 0.25;         // s, of a wavelet with more than the fewest half cycles
constexpr double kSamplesPerPeriod = 40;  // of the highest oscillator: the filter errs by (ωh)²/12, 0.2 %
constexpr int kRounds = 80;
constexpr double kAllowed = 3;  // dB, what shock standards allow on either side

struct Wavelet {
    double frequency = 0, amplitude = 0;
    int half_cycles = 0;

    double duration() const { return half_cycles / (2 * frequency); }
    double calcValue(double t) const {
        if (!(t >= 0 && t <= duration())) return 0;
        const double angle = kTwoPi * frequency * t;
        return amplitude * std::sin(angle / half_cycles) * std::sin(angle);
    }
};

class WaveletShock : public Signal {
public:
    WaveletShock(std::vector<Wavelet> wavelets, double rest) : wavelets_(std::move(wavelets)), duration_(rest) {
        double longest = 0;
        for (const Wavelet& wavelet : wavelets_) longest = std::max(longest, wavelet.duration());
        duration_ += longest;
    }
    double duration() const override { return duration_; }
    double value(double t) const override {
        double sum = 0;
        for (const Wavelet& wavelet : wavelets_) sum += wavelet.calcValue(t);
        return sum;
    }
    double phase(double) const override { return 0; }
    double frequency(double) const override { return highestFrequency(); }
    double highestFrequency() const override { return wavelets_.back().frequency; }
    /// Rest before and after.
    std::optional<Integrals> integralsAtStart() const override { return Integrals{}; }

private:
    std::vector<Wavelet> wavelets_;
    double duration_;
};

std::vector<Wavelet> placeWavelets(const Breakpoints& spectrum) {
    std::vector<Wavelet> wavelets;
    const double octaves = std::log2(spectrum.frequency.back() / spectrum.frequency.front());
    const int count = std::max(1, static_cast<int>(std::lround(octaves * kWaveletsPerOctave)));
    for (int m = 0; m <= count; ++m) {
        Wavelet wavelet;
        wavelet.frequency = spectrum.frequency.front() * std::exp2(octaves * m / count);
        const int half_cycles = static_cast<int>(2 * wavelet.frequency * kLongest);
        wavelet.half_cycles = std::clamp(half_cycles, kFewestHalfCycles, kMostHalfCycles) | 1;
        // An oscillator with Q = 10 amplifies such a wavelet about fivefold.
        constexpr double amplification = 5;
        const double demanded = spectrum.calcValue(std::min(wavelet.frequency, spectrum.frequency.back()));
        wavelet.amplitude = (m % 2 == 0 ? 1 : -1) * demanded / amplification;
        wavelets.push_back(wavelet);
    }
    return wavelets;
}

Eigen::VectorXd sample(const std::vector<Wavelet>& wavelets, double interval) {
    const WaveletShock shock(wavelets, 0);
    const auto count = static_cast<Eigen::Index>(std::ceil(shock.duration() / interval)) + 1;
    return Eigen::VectorXd::NullaryExpr(count,
                                        [&](Eigen::Index k) { return shock.value(static_cast<double>(k) * interval); });
}

/// dB, achieved over demanded.
struct Deviation {
    double least = INFINITY, most = -INFINITY;
    double largest() const { return std::max(-least, most); }
};

Deviation compareSpectra(const Breakpoints& spectrum, const std::vector<double>& looks,
                         const Eigen::VectorXd& achieved) {
    Deviation deviation;
    for (std::size_t i = 0; i < looks.size(); ++i) {
        const double f = std::clamp(looks[i], spectrum.frequency.front(), spectrum.frequency.back());
        const double decibels = 20 * std::log10(achieved[i] / spectrum.calcValue(f));
        deviation.least = std::min(deviation.least, decibels);
        deviation.most = std::max(deviation.most, decibels);
    }
    return deviation;
}

}  // namespace

Breakpoints parseShockSpectrum(std::string_view text, const std::string& file) {
    return parseBreakpoints(text, file, {"shock response", "g, m/s^2", [](const std::string& unit, const auto& where) {
                                             return findUnitFactor(unit.empty() ? "g" : unit, Quantity::acceleration,
                                                                   where);
                                         }});
}

Breakpoints readShockSpectrum(const std::string& file) {
    return parseShockSpectrum(TextFile(file).view(), file);
}

ShockSynthesis synthesizeShock(const Breakpoints& spectrum, double quality, double rest) {
    const double highest = spectrum.frequency.back(), interval = 1 / (kSamplesPerPeriod * highest);
    std::vector<Wavelet> wavelets = placeWavelets(spectrum), best;
    std::vector<double> own;
    for (const Wavelet& wavelet : wavelets) own.push_back(wavelet.frequency);
    const std::vector<double> looks = makeOctaves(spectrum.frequency.front(), highest, kLooksPerOctave);
    Deviation reached;
    double smallest = INFINITY;
    for (int round = 0; round < kRounds; ++round) {
        const Eigen::VectorXd samples = sample(wavelets, interval);
        const Deviation deviation =
            compareSpectra(spectrum, looks, calcShockResponse(samples, interval, looks, quality).maximax);
        if (deviation.largest() < smallest) {
            smallest = deviation.largest();
            reached = deviation;
            best = wavelets;
        }
        const Eigen::VectorXd achieved = calcShockResponse(samples, interval, own, quality).maximax;
        for (std::size_t m = 0; m < wavelets.size(); ++m) {
            const double f = std::min(own[m], highest);
            // Half of what is lacking: neighbours change with it.
            wavelets[m].amplitude *= std::sqrt(spectrum.calcValue(f) / achieved[m]);
        }
    }
    if (!(smallest <= kAllowed))
        throw InputError(
            {{}, 0, "srs"},
            "is met within " + formatNumber(reached.least, 2) + " to " + formatNumber(reached.most, 2) + " dB only",
            "a spectrum that wavelets meet within 3 dB: wider, or less steep than 12 dB an octave");
    return {std::make_shared<WaveletShock>(best, rest), reached.least, reached.most};
}

}  // namespace wems
