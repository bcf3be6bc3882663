/// @file
/// Excitation signals as pure functions of time: value, phase and instantaneous frequency.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "models/power_spectrum.hpp"

namespace wems {

/// A signal of unit amplitude. Zero outside [0, duration()].
class Signal {
public:
    virtual ~Signal() = default;
    virtual double duration() const = 0;       ///< s
    virtual double value(double t) const = 0;  ///< -, within ±1 (random: unit RMS)
    virtual double phase(double t) const = 0;  ///< rad; of a random signal 0
    virtual double frequency(
        double t) const = 0;  ///< instantaneous frequency, Hz; of a random signal its upper band limit
    /// Hz, the fastest that the signal holds; a shock holds more, ever less of it.
    virtual double highestFrequency() const = 0;
    /// Times (s) within the duration at which the signal's slope jumps.
    virtual std::vector<double> kinks() const { return {}; }

    /// First (s) and second (s²) integral at t = 0 of a sum of sines, such that neither drifts: what a velocity and a
    /// displacement start with whose acceleration the signal is. None where the signal is no such sum.
    struct Integrals {
        double first = 0, second = 0;
    };
    virtual std::optional<Integrals> integralsAtStart() const { return std::nullopt; }
};

/// Raised-cosine fade at start and end, s.
struct Fade {
    double start = 0, end = 0;
};

/// f(t) = f0 2^(r t), phase 2π f0 (2^(r t) − 1) / (r ln 2), r = rate/60 octaves per second; f1 < f0 sweeps downwards.
/// @throws InputError on frequencies or rate that are not positive, or equal frequencies.
std::unique_ptr<Signal> makeLogarithmicSweep(double f0, double f1, double octaves_per_minute, Fade fade = {});
/// f(t) = f0 ± rate t, Hz per second.
std::unique_ptr<Signal> makeLinearSweep(double f0, double f1, double hertz_per_second, Fade fade = {});
std::unique_ptr<Signal> makeDwell(double frequency, double duration, Fade fade = {});
/// A shock: sin(π t / T) for T = `pulse` s, then nothing for `rest` s. Its frequency is that of the sine, 1/(2 T).
std::unique_ptr<Signal> makeHalfSine(double pulse, double rest);
/// A shock: a terminal-peak sawtooth, t/T for T = `pulse` s, then nothing for `rest` s. Frequency as of makeHalfSine().
std::unique_ptr<Signal> makeSawtooth(double pulse, double rest);
/// A shock: up within a tenth of `pulse` s, down within the last tenth, then nothing for `rest` s.
std::unique_ptr<Signal> makeTrapezoid(double pulse, double rest);
/// Stationary Gaussian noise in a band: a sum of sines with random phases from the seed, unit RMS; same seed, same
/// signal.
std::unique_ptr<Signal> makeBandLimitedRandom(double f0, double f1, double duration, std::uint64_t seed,
                                              Fade fade = {});

/// The acceleration of a displacement sin φ, φ the phase of a sweep or dwell without fades: φ'' cos φ − φ'² sin φ,
/// 1/s². Its integrals at the start are those of that displacement.
std::unique_ptr<Signal> makeDisplacementDriven(std::shared_ptr<const Signal> swept);

/// Stationary Gaussian noise with a given spectrum: sines at all multiples of 1/duration in the band, each with the
/// mean square that the spectrum has in its 1/duration, phases from the seed. Over the duration the periodogram is the
/// spectrum and the RMS its RMS, not on average only. Unit of the spectrum, not unit RMS.
/// @throws InputError if the duration is too short for the band, or too long to be held in memory (2^26 values).
std::unique_ptr<Signal> makeRandomFromSpectrum(const PowerSpectrum& spectrum, double duration, std::uint64_t seed,
                                               Fade fade = {});

}  // namespace wems
