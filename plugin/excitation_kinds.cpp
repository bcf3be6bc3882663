#include "plugin/excitation_kinds.hpp"

#include <cmath>
#include <cstdlib>
#include <sstream>

#include "models/error.hpp"
#include "models/format_number.hpp"
#include "models/shock_synthesis.hpp"
#include "models/sweep_profile.hpp"
#include "plugin/simulate_options.hpp"

namespace wems::plugin {
namespace {

/// `5:50` as numbers, exactly `count` of them and all positive.
std::vector<double> parseColons(const std::string& text, std::size_t count, const std::string& option,
                                const std::string& accepted) {
    std::vector<double> numbers;
    std::stringstream stream(text);
    for (std::string part; std::getline(stream, part, ':');) {
        char* end = nullptr;
        const double value = std::strtod(part.c_str(), &end);
        if (part.empty() || *end != '\0' || !std::isfinite(value) || !(value > 0)) break;
        numbers.push_back(value);
    }
    std::string rest;
    if (numbers.size() != count || stream >> rest || text.back() == ':')
        throw InputError({"", 0, option}, "`" + text + "` is not understood", accepted);
    return numbers;
}

constexpr double kUsualRate = 4;  // octaves per minute

Fade fadeOf(const SimulateOptions& options) {
    return {options.fade, options.fade};
}

NamedSignal makeSweep(const std::string& value, const SimulateOptions& options) {
    const auto f = parseColons(value, 2, "--sweep", "two frequencies in Hz, such as 5:50");
    const std::string range = "sine sweep " + formatNumber(f[0]) + " to " + formatNumber(f[1]) + " Hz, ";
    if (options.hertz_per_second)
        return {makeLinearSweep(f[0], f[1], *options.hertz_per_second, fadeOf(options)), true,
                range + formatNumber(*options.hertz_per_second) + " Hz per second"};
    const double rate = options.octaves_per_minute.value_or(kUsualRate);
    return {makeLogarithmicSweep(f[0], f[1], rate, fadeOf(options)), true,
            range + formatNumber(rate) + " octaves per minute"};
}

NamedSignal makeDwellSignal(const std::string& value, const SimulateOptions& options) {
    const auto f = parseColons(value, 2, "--dwell", "frequency in Hz and duration in s, such as 30:10");
    return {makeDwell(f[0], f[1], fadeOf(options)), true,
            "dwell at " + formatNumber(f[0]) + " Hz, " + formatNumber(f[1]) + " s"};
}

using MakePulse = std::unique_ptr<Signal> (*)(double pulse, double rest);

NamedSignal makePulse(const std::string& value, const SimulateOptions& options, const std::string& option,
                      const std::string& name, MakePulse make) {
    const auto times = parseColons(value, 2, option, "durations of pulse and rest in s, such as 0.011:1");
    if (options.fade > 0)
        throw InputError({"", 0, "--fade"}, "does not go with " + option, "an excitation that is no pulse");
    return {make(times[0], times[1]), false,
            name + " of " + formatNumber(times[0]) + " s, then " + formatNumber(times[1]) + " s of rest"};
}

NamedSignal makeHalfSineSignal(const std::string& value, const SimulateOptions& options) {
    return makePulse(value, options, "--half-sine", "half sine", makeHalfSine);
}
NamedSignal makeSawtoothSignal(const std::string& value, const SimulateOptions& options) {
    return makePulse(value, options, "--sawtooth", "sawtooth", makeSawtooth);
}
NamedSignal makeTrapezoidSignal(const std::string& value, const SimulateOptions& options) {
    return makePulse(value, options, "--trapezoid", "trapezoid", makeTrapezoid);
}

/// What a file prescribes may be scaled by a factor, not given another level.
void refuseUnit(const SimulateOptions& options, const std::string& option) {
    if (options.level_has_unit)
        throw InputError({"", 0, "level"}, "has a unit, but " + option + " says the level itself",
                         "an axis, or a factor such as z=0.5");
}

NamedSignal makeProfile(const std::string& value, const SimulateOptions& options) {
    const SweepProfile profile = readSweepProfile(value);
    refuseUnit(options, "--profile");
    const bool force = !options.force.isZero();
    if (force != profile.isForce())
        throw InputError({value, 0, "profile"}, force ? "is of a motion" : "is of a force",
                         force ? "levels in N for --force" : "levels in mm, mm/s or g for --base-acceleration");
    double from = profile.lowest(), to = profile.highest();
    if (options.downwards) std::swap(from, to);
    std::shared_ptr<const Signal> sweep;
    std::string rate;
    if (options.hertz_per_second) {
        sweep = makeLinearSweep(from, to, *options.hertz_per_second);
        rate = formatNumber(*options.hertz_per_second) + " Hz per second";
    } else {
        const double octaves = options.octaves_per_minute.value_or(kUsualRate);
        sweep = makeLogarithmicSweep(from, to, octaves);
        rate = formatNumber(octaves) + " octaves per minute";
    }
    std::string changes;
    for (const double f : profile.findChanges()) changes += (changes.empty() ? "" : ", ") + formatNumber(f, 4);
    return {makeProfiledSweep(sweep, profile, fadeOf(options)), true,
            "sine sweep " + formatNumber(from) + " to " + formatNumber(to) + " Hz by the profile of " + value + ", " +
                rate + (changes.empty() ? "" : ", level changes at " + changes + " Hz")};
}

NamedSignal makeShock(const std::string& value, const SimulateOptions& options) {
    refuseUnit(options, "--srs");
    if (!options.force.isZero()) throw InputError({"", 0, "--force"}, "does not go with --srs", "--base-acceleration");
    if (options.fade > 0)
        throw InputError({"", 0, "--fade"}, "does not go with --srs", "an excitation that is no pulse");
    constexpr double usual_rest = 1;  // s
    const double quality = options.quality.value_or(10);
    const ShockSynthesis shock = synthesizeShock(readShockSpectrum(value), quality, usual_rest);
    return {shock.signal, false,
            "shock with the response spectrum of " + value + ", Q " + formatNumber(quality) + ", met within " +
                formatNumber(shock.least_decibels, 2) + " to " + formatNumber(shock.most_decibels, 2) + " dB"};
}

NamedSignal makeRandom(const std::string& value, const SimulateOptions& options) {
    const auto f = parseColons(value, 3, "--random", "band in Hz and duration in s, such as 5:50:60");
    return {makeBandLimitedRandom(f[0], f[1], f[2], options.seed, fadeOf(options)), false,
            "random " + formatNumber(f[0]) + " to " + formatNumber(f[1]) + " Hz, " + formatNumber(f[2]) + " s"};
}

NamedSignal makeSpectrumRandom(const std::string& value, const SimulateOptions& options) {
    constexpr double usual_duration = 60;  // s
    const double duration = options.duration.value_or(usual_duration);
    return {makeRandomFromSpectrum(readLevelledSpectrum(options), duration, options.seed, fadeOf(options)), false,
            "random by the spectrum of " + value + ", " + formatNumber(duration) + " s"};
}

}  // namespace

PowerSpectrum readLevelledSpectrum(const SimulateOptions& options) {
    PowerSpectrum spectrum = readPowerSpectrum(options.signal);
    const bool force = !options.force.isZero();
    if (force != (spectrum.quantity() == Quantity::force))
        throw InputError({options.signal, 0, "psd"}, force ? "is of an acceleration" : "is of a force",
                         force ? "N^2/Hz for --force" : "g^2/Hz for --base-acceleration");
    if (!options.level_has_unit) return spectrum;
    if (options.level_is_bare)
        throw InputError({"", 0, "level"}, "has an axis with a unit and one without a value",
                         "RMS values with units, such as z=1.5g, or factors, such as z or z=0.5");
    std::vector<double> density = spectrum.density();
    const double mean_square = std::pow(spectrum.calcRms(), 2);
    for (double& value : density) value /= mean_square;
    return {spectrum.frequency(), std::move(density), spectrum.quantity()};
}

const std::vector<ExcitationKind>& excitationKinds() {
    static const std::vector<ExcitationKind> kinds{
        {"--sweep", "f0:f1", "sine sweep f0:f1 in Hz, downwards if f1 < f0", true, false, false, makeSweep},
        {"--profile", "FILE",
         "sine sweep by the rows of FILE, `from,to,level` in Hz and mm, mm/s, g or N; the lowest level of the rows at "
         "a "
         "frequency holds, so that crossovers and notches follow",
         true, true, false, makeProfile},
        {"--dwell", "f:duration", "sine f:duration in Hz and s", false, false, false, makeDwellSignal},
        {"--half-sine", "duration:rest", "shock, half a sine duration:rest in s, the rest following it", false, false,
         false, makeHalfSineSignal},
        {"--sawtooth", "duration:rest", "shock, a terminal-peak sawtooth duration:rest in s", false, false, false,
         makeSawtoothSignal},
        {"--trapezoid", "duration:rest", "shock, a trapezoid duration:rest in s", false, false, false,
         makeTrapezoidSignal},
        {"--srs", "FILE", "shock with the response spectrum of FILE (Hz, g), a sum of wavelets", false, true, false,
         makeShock},
        {"--random", "f0:f1:duration", "band-limited noise f0:f1:duration in Hz and s; levels are RMS", false, false,
         false, makeRandom},
        {"--psd", "FILE",
         "random by breakpoints in FILE (Hz, g^2/Hz), for --duration (60 s); the level names axes (z), an RMS (z=1.5g) "
         "or a "
         "factor (z=0.5)",
         false, true, true, makeSpectrumRandom}};
    return kinds;
}

}  // namespace wems::plugin
