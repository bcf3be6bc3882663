#include "models/excitation.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "models/error.hpp"
#include "models/format_number.hpp"
#include "models/pi.hpp"

namespace wems {
namespace {

constexpr double ln2 = 0.6931471805599453;

void requirePositive(const std::string& key, double value, const std::string& unit) {
    if (std::isfinite(value) && value > 0) return;
    throw InputError({{}, 0, key}, "is " + formatNumber(value), "a number above 0, " + unit);
}

void requireDifferent(double f0, double f1) {
    if (f0 != f1) return;
    throw InputError({{}, 0, "sweep"}, "starts and ends at " + formatNumber(f0) + " Hz",
                     "two different frequencies; a dwell for one");
}

/// What all signals share: support and fades.
class FadedSignal : public Signal {
public:
    FadedSignal(double duration, Fade fade) : duration_(duration), fade_(fade) {
        if (!(fade.start >= 0 && fade.end >= 0 && fade.start + fade.end <= duration)) {
            throw InputError(
                {{}, 0, "fade"}, "is " + formatNumber(fade.start) + " s and " + formatNumber(fade.end) + " s",
                "times from 0 on, together not longer than the signal's " + formatNumber(duration, 6) + " s");
        }
    }
    double duration() const final { return duration_; }
    double value(double t) const final {
        if (!(t >= 0 && t <= duration_)) return 0;
        double weight = 1;
        if (t < fade_.start) weight *= 0.5 * (1 - std::cos(kPi * t / fade_.start));
        if (duration_ - t < fade_.end) weight *= 0.5 * (1 - std::cos(kPi * (duration_ - t) / fade_.end));
        return weight * unfadedValue(t);
    }

protected:
    virtual double unfadedValue(double t) const { return std::sin(phase(t)); }

private:
    double duration_;
    Fade fade_;
};

class LogarithmicSweep : public FadedSignal {
public:
    LogarithmicSweep(double f0, double f1, double octaves_per_second, Fade fade)
        : FadedSignal(std::abs(std::log2(f1 / f0)) / octaves_per_second, fade),
          f0_(f0),
          rate_(f1 > f0 ? octaves_per_second : -octaves_per_second) {}
    // expm1 keeps the digits at the start, where 2^(r t) − 1 is small.
    double phase(double t) const override { return kTwoPi * f0_ * std::expm1(rate_ * ln2 * t) / (rate_ * ln2); }
    double frequency(double t) const override { return f0_ * std::exp2(rate_ * t); }

private:
    double f0_, rate_;
};

class LinearSweep : public FadedSignal {
public:
    LinearSweep(double f0, double f1, double hertz_per_second, Fade fade)
        : FadedSignal(std::abs(f1 - f0) / hertz_per_second, fade),
          f0_(f0),
          rate_(f1 > f0 ? hertz_per_second : -hertz_per_second) {}
    double phase(double t) const override { return kTwoPi * (f0_ + 0.5 * rate_ * t) * t; }
    double frequency(double t) const override { return f0_ + rate_ * t; }

private:
    double f0_, rate_;
};

class Dwell : public FadedSignal {
public:
    Dwell(double frequency, double duration, Fade fade) : FadedSignal(duration, fade), frequency_(frequency) {}
    double phase(double t) const override { return kTwoPi * frequency_ * t; }
    double frequency(double) const override { return frequency_; }

private:
    double frequency_;
};

class HalfSine : public FadedSignal {
public:
    HalfSine(double pulse, double rest) : FadedSignal(pulse + rest, {}), pulse_(pulse) {}
    double phase(double t) const override { return kPi * std::min(t / pulse_, 1.0); }
    double frequency(double t) const override { return t <= pulse_ ? 0.5 / pulse_ : 0.0; }

protected:
    double unfadedValue(double t) const override { return t < pulse_ ? std::sin(phase(t)) : 0.0; }

private:
    double pulse_;
};

/// Sines of equal amplitude at multiples of 1/duration, so that they are orthogonal over the duration and the RMS is
/// exactly one. A wide band is thinned to one line in each of `most_lines` equal parts, chosen at random: Gaussian
/// enough, not periodic within the duration, and cheap.
class BandLimitedRandom : public FadedSignal {
public:
    BandLimitedRandom(double f0, double f1, double duration, std::uint64_t seed, Fade fade)
        : FadedSignal(duration, fade), upper_(f1) {
        constexpr double most_lines = 256;
        const double first = std::ceil(f0 * duration - 1e-9), last = std::floor(f1 * duration + 1e-9);
        const double available = last - first + 1;
        if (available < 1) {
            throw InputError({{}, 0, "random"}, "the band is narrower than the resolution of the duration",
                             "a longer duration or a wider band");
        }
        std::mt19937_64 generator(seed);
        const auto draw = [&generator] { return static_cast<double>(generator() >> 11U) * 0x1p-53; };
        const auto lines = static_cast<int>(std::min(available, most_lines));
        for (int i = 0; i < lines; ++i) {
            const double from = std::floor(i * available / lines), to = std::floor((i + 1) * available / lines);
            const double multiple = first + from + std::floor(draw() * (to - from));
            lines_.push_back({kTwoPi * multiple / duration, kTwoPi * draw()});
        }
        amplitude_ = std::sqrt(2.0 / lines);
    }
    double phase(double) const override { return 0; }
    double frequency(double) const override { return upper_; }

protected:
    double unfadedValue(double t) const override {
        double sum = 0;
        for (const Line& line : lines_) sum += std::sin(line.omega * t + line.phase);
        return amplitude_ * sum;
    }

private:
    struct Line {
        double omega, phase;
    };
    std::vector<Line> lines_;
    double upper_, amplitude_ = 1;
};

}  // namespace

std::unique_ptr<Signal> makeLogarithmicSweep(double f0, double f1, double octaves_per_minute, Fade fade) {
    requirePositive("sweep", f0, "Hz");
    requirePositive("sweep", f1, "Hz");
    requirePositive("rate", octaves_per_minute, "octaves per minute");
    requireDifferent(f0, f1);
    return std::make_unique<LogarithmicSweep>(f0, f1, octaves_per_minute / 60, fade);
}

std::unique_ptr<Signal> makeLinearSweep(double f0, double f1, double hertz_per_second, Fade fade) {
    requirePositive("sweep", f0, "Hz");
    requirePositive("sweep", f1, "Hz");
    requirePositive("rate", hertz_per_second, "Hz per second");
    requireDifferent(f0, f1);
    return std::make_unique<LinearSweep>(f0, f1, hertz_per_second, fade);
}

std::unique_ptr<Signal> makeDwell(double frequency, double duration, Fade fade) {
    requirePositive("dwell", frequency, "Hz");
    requirePositive("duration", duration, "s");
    return std::make_unique<Dwell>(frequency, duration, fade);
}

std::unique_ptr<Signal> makeHalfSine(double pulse, double rest) {
    requirePositive("half-sine", pulse, "s");
    requirePositive("rest", rest, "s");
    return std::make_unique<HalfSine>(pulse, rest);
}

std::unique_ptr<Signal> makeBandLimitedRandom(double f0, double f1, double duration, std::uint64_t seed, Fade fade) {
    requirePositive("random", f0, "Hz");
    requirePositive("random", f1, "Hz");
    requirePositive("duration", duration, "s");
    if (f1 < f0) {
        throw InputError({{}, 0, "random"}, "the band ends below its start", "lower:upper, Hz");
    }
    return std::make_unique<BandLimitedRandom>(f0, f1, duration, seed, fade);
}

}  // namespace wems
