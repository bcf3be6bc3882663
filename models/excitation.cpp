#include "models/excitation.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <random>
#include <unsupported/Eigen/FFT>
#include <utility>
#include <vector>

#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/common/units.hpp"

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
    bool isFaded() const { return fade_.start > 0 || fade_.end > 0; }

private:
    double duration_;
    Fade fade_;
};

/// One of a sum: amplitude · sin(omega t + phase).
Signal::Integrals integrateAtStart(double amplitude, double omega, double phase) {
    return {-amplitude * std::cos(phase) / omega, -amplitude * std::sin(phase) / (omega * omega)};
}

class LogarithmicSweep : public FadedSignal {
public:
    LogarithmicSweep(double f0, double f1, double octaves_per_second, Fade fade)
        : FadedSignal(std::abs(std::log2(f1 / f0)) / octaves_per_second, fade),
          f0_(f0),
          rate_(f1 > f0 ? octaves_per_second : -octaves_per_second) {}
    // expm1 keeps the digits at the start, where 2^(r t) − 1 is small.
    double phase(double t) const override { return kTwoPi * f0_ * std::expm1(rate_ * ln2 * t) / (rate_ * ln2); }
    double frequency(double t) const override { return f0_ * std::exp2(rate_ * t); }
    double highestFrequency() const override { return std::max(frequency(0), frequency(duration())); }

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
    double highestFrequency() const override { return std::max(frequency(0), frequency(duration())); }

private:
    double f0_, rate_;
};

class Dwell : public FadedSignal {
public:
    Dwell(double frequency, double duration, Fade fade) : FadedSignal(duration, fade), frequency_(frequency) {}
    double phase(double t) const override { return kTwoPi * frequency_ * t; }
    double frequency(double) const override { return frequency_; }
    double highestFrequency() const override { return frequency_; }
    std::optional<Integrals> integralsAtStart() const override {
        if (isFaded()) return std::nullopt;
        return integrateAtStart(1, kTwoPi * frequency_, 0);
    }

private:
    double frequency_;
};

class HalfSine : public FadedSignal {
public:
    HalfSine(double pulse, double rest) : FadedSignal(pulse + rest, {}), pulse_(pulse) {}
    double phase(double t) const override { return kPi * std::min(t / pulse_, 1.0); }
    double frequency(double t) const override { return t <= pulse_ ? 0.5 / pulse_ : 0.0; }
    double highestFrequency() const override { return 0.5 / pulse_; }
    std::vector<double> kinks() const override { return {pulse_}; }

protected:
    double unfadedValue(double t) const override { return t < pulse_ ? std::sin(phase(t)) : 0.0; }

private:
    double pulse_;
};

/// Straight lines between corners of a pulse (shares of its length), then rest. A jump is two corners at one place.
class LinearPulse : public FadedSignal {
public:
    struct Corner {
        double place, value;
    };
    LinearPulse(std::vector<Corner> corners, double pulse, double rest)
        : FadedSignal(pulse + rest, {}), corners_(std::move(corners)), pulse_(pulse) {}
    double phase(double) const override { return 0; }
    double frequency(double t) const override { return t <= pulse_ ? 0.5 / pulse_ : 0.0; }
    double highestFrequency() const override { return 0.5 / pulse_; }
    std::vector<double> kinks() const override {
        std::vector<double> times;
        for (const Corner& corner : corners_)
            if (corner.place > 0) times.push_back(corner.place * pulse_);
        return times;
    }

protected:
    double unfadedValue(double t) const override {
        const double place = t / pulse_;
        for (std::size_t i = 1; i < corners_.size(); ++i) {
            const Corner &a = corners_[i - 1], &b = corners_[i];
            if (place < b.place) return a.value + (b.value - a.value) * (place - a.place) / (b.place - a.place);
        }
        return 0;
    }

private:
    std::vector<Corner> corners_;
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
    double highestFrequency() const override { return upper_; }
    std::optional<Integrals> integralsAtStart() const override {
        if (isFaded()) return std::nullopt;
        Integrals sum;
        for (const Line& line : lines_) {
            const Integrals one = integrateAtStart(amplitude_, line.omega, line.phase);
            sum.first += one.first;
            sum.second += one.second;
        }
        return sum;
    }

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

class DisplacementDriven : public Signal {
public:
    explicit DisplacementDriven(std::shared_ptr<const Signal> swept) : swept_(std::move(swept)) {}
    double duration() const override { return swept_->duration(); }
    double value(double t) const override {
        if (!(t >= 0 && t <= duration())) return 0;
        // The rate of a sweep is smooth: its central difference errs by the square of the step over the duration.
        const double step = 1e-4 * duration();
        const double rate = kTwoPi * (swept_->frequency(t + step) - swept_->frequency(t - step)) / (2 * step);
        const double omega = kTwoPi * swept_->frequency(t), angle = swept_->phase(t);
        return rate * std::cos(angle) - omega * omega * std::sin(angle);
    }
    double phase(double t) const override { return swept_->phase(t); }
    double frequency(double t) const override { return swept_->frequency(t); }
    double highestFrequency() const override { return swept_->highestFrequency(); }
    std::optional<Integrals> integralsAtStart() const override {
        const double angle = swept_->phase(0);
        return Integrals{kTwoPi * swept_->frequency(0) * std::cos(angle), std::sin(angle)};
    }

private:
    std::shared_ptr<const Signal> swept_;
};

/// Value, first and second derivative of the sum of sines in a table over the duration, which is its period, by inverse
/// FFT; between its rows the polynomial of fifth degree through both neighbours. With at least 16 rows in a period of
/// the highest frequency it errs by (ωh)^6/46080 < 8e-8 of a sine of that frequency.
class SpectrumRandom : public FadedSignal {
public:
    SpectrumRandom(const PowerSpectrum& spectrum, double duration, std::uint64_t seed, Fade fade)
        : FadedSignal(duration, fade), upper_(spectrum.highest()) {
        const double first = std::ceil(spectrum.lowest() * duration * (1 - 1e-12));
        const double last = std::floor(spectrum.highest() * duration * (1 + 1e-12));
        const double lower_bound = 1 / duration;
        if (!(last - first >= 1) || first < 1) {
            throw InputError({{}, 0, "psd"},
                             "the duration of " + formatNumber(duration) + " s resolves " +
                                 formatNumber(lower_bound, 4) + " Hz, too coarse for the spectrum",
                             "a longer --duration");
        }
        constexpr double rows_per_period = 16, most_rows = 1 << 26;
        double rows = 64;
        while (rows < rows_per_period * last) rows *= 2;
        if (rows > most_rows) {
            throw InputError({{}, 0, "psd"}, "the duration of " + formatNumber(duration) + " s takes too much memory",
                             "at most " + formatNumber(most_rows / rows_per_period / upper_, 3) + " s at this band");
        }
        std::mt19937_64 generator(seed);
        const auto count = static_cast<std::size_t>(rows);
        step_ = duration / rows;
        std::vector<std::complex<double>> lines(count / 2 + 1), slopes = lines, curvatures = lines;
        Integrals integrals;
        for (double multiple = first; multiple <= last; ++multiple) {
            // The mean square of the band half a line to both sides, at the ends of the spectrum up to its end.
            const double from = multiple == first ? spectrum.lowest() : (multiple - 0.5) / duration;
            const double to = multiple == last ? spectrum.highest() : (multiple + 0.5) / duration;
            const double amplitude = std::sqrt(2 * spectrum.calcMeanSquare(from, to));
            const double phase = kTwoPi * (static_cast<double>(generator() >> 11U) * 0x1p-53);
            const double omega = kTwoPi * multiple / duration;
            // a sin(ωt + φ) = Re(−i a e^{iφ} e^{iωt}); half of it stands at each of ±ω, times rows for the inverse FFT.
            const std::complex<double> line = rows / 2 * amplitude * std::polar(1.0, phase - kPi / 2);
            const auto k = static_cast<std::size_t>(multiple);
            lines[k] = line;
            slopes[k] = std::complex<double>(0, omega) * line;
            curvatures[k] = -omega * omega * line;
            const Integrals one = integrateAtStart(amplitude, omega, phase);
            integrals.first += one.first;
            integrals.second += one.second;
        }
        start_ = integrals;
        Eigen::FFT<double> transform;
        transform.SetFlag(Eigen::FFT<double>::HalfSpectrum);
        transform.inv(value_, lines);
        transform.inv(slope_, slopes);
        transform.inv(curvature_, curvatures);
    }
    double phase(double) const override { return 0; }
    double frequency(double) const override { return upper_; }
    double highestFrequency() const override { return upper_; }
    std::optional<Integrals> integralsAtStart() const override {
        if (isFaded()) return std::nullopt;
        return start_;
    }

protected:
    double unfadedValue(double t) const override {
        const double place = t / step_;
        const double row = std::floor(place), u = place - row;
        const std::size_t i = static_cast<std::size_t>(row) % value_.size(), j = (i + 1) % value_.size();
        // Hermite's basis of fifth degree.
        const double u2 = u * u, u3 = u2 * u, w = 1 - u, w2 = w * w, w3 = w2 * w;
        const double h = step_;
        return w3 * (1 + 3 * u + 6 * u2) * value_[i] + w3 * u * (1 + 3 * u) * h * slope_[i] +
               0.5 * w3 * u2 * h * h * curvature_[i] + u3 * (1 + 3 * w + 6 * w2) * value_[j] -
               u3 * w * (1 + 3 * w) * h * slope_[j] + 0.5 * u3 * w2 * h * h * curvature_[j];
    }

private:
    std::vector<double> value_, slope_, curvature_;
    double upper_, step_ = 0;
    Integrals start_;
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

std::unique_ptr<Signal> makeSawtooth(double pulse, double rest) {
    requirePositive("sawtooth", pulse, "s");
    requirePositive("rest", rest, "s");
    return std::make_unique<LinearPulse>(std::vector<LinearPulse::Corner>{{0, 0}, {1, 1}}, pulse, rest);
}

std::unique_ptr<Signal> makeTrapezoid(double pulse, double rest) {
    requirePositive("trapezoid", pulse, "s");
    requirePositive("rest", rest, "s");
    constexpr double ramp = 0.1;
    return std::make_unique<LinearPulse>(std::vector<LinearPulse::Corner>{{0, 0}, {ramp, 1}, {1 - ramp, 1}, {1, 0}},
                                         pulse, rest);
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

std::unique_ptr<Signal> makeDisplacementDriven(std::shared_ptr<const Signal> swept) {
    return std::make_unique<DisplacementDriven>(std::move(swept));
}

std::unique_ptr<Signal> makeRandomFromSpectrum(const PowerSpectrum& spectrum, double duration, std::uint64_t seed,
                                               Fade fade) {
    requirePositive("duration", duration, "s");
    return std::make_unique<SpectrumRandom>(spectrum, duration, seed, fade);
}

}  // namespace wems
