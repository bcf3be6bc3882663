#include "plugin/excitation_kinds.hpp"

#include <cmath>
#include <cstdlib>
#include <sstream>

#include "models/error.hpp"
#include "models/format_number.hpp"
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

Fade fadeOf(const SimulateOptions& options) {
    return {options.fade, options.fade};
}

NamedSignal makeSweep(const std::string& value, const SimulateOptions& options) {
    const auto f = parseColons(value, 2, "--sweep", "two frequencies in Hz, such as 5:50");
    const std::string range = "sine sweep " + formatNumber(f[0]) + " to " + formatNumber(f[1]) + " Hz, ";
    if (options.hertz_per_second)
        return {makeLinearSweep(f[0], f[1], *options.hertz_per_second, fadeOf(options)), true,
                range + formatNumber(*options.hertz_per_second) + " Hz per second"};
    const double rate = options.octaves_per_minute.value_or(4);
    return {makeLogarithmicSweep(f[0], f[1], rate, fadeOf(options)), true,
            range + formatNumber(rate) + " octaves per minute"};
}

NamedSignal makeDwellSignal(const std::string& value, const SimulateOptions& options) {
    const auto f = parseColons(value, 2, "--dwell", "frequency in Hz and duration in s, such as 30:10");
    return {makeDwell(f[0], f[1], fadeOf(options)), true,
            "dwell at " + formatNumber(f[0]) + " Hz, " + formatNumber(f[1]) + " s"};
}

NamedSignal makeHalfSineSignal(const std::string& value, const SimulateOptions& options) {
    const auto times = parseColons(value, 2, "--half-sine", "durations of pulse and rest in s, such as 0.011:1");
    if (options.fade > 0)
        throw InputError({"", 0, "--fade"}, "does not go with --half-sine", "an excitation that is no pulse");
    return {makeHalfSine(times[0], times[1]), false,
            "half sine of " + formatNumber(times[0]) + " s, then " + formatNumber(times[1]) + " s of rest"};
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
        {"--sweep", "f0:f1", "sine sweep f0:f1 in Hz, downwards if f1 < f0", true, false, makeSweep},
        {"--dwell", "f:duration", "sine f:duration in Hz and s", false, false, makeDwellSignal},
        {"--half-sine", "duration:rest", "shock, half a sine duration:rest in s, the rest following it", false, false,
         makeHalfSineSignal},
        {"--random", "f0:f1:duration", "band-limited noise f0:f1:duration in Hz and s; levels are RMS", false, false,
         makeRandom},
        {"--psd", "FILE",
         "random by breakpoints in FILE (Hz, g^2/Hz), for --duration (60 s); the level names axes (z), an RMS (z=1.5g) "
         "or a "
         "factor (z=0.5)",
         false, true, makeSpectrumRandom}};
    return kinds;
}

}  // namespace wems::plugin
