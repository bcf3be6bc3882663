#include "plugin/excitation_kinds.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <set>
#include <sstream>

#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/sensor_reading.hpp"
#include "models/shock.hpp"
#include "models/sweep_profile.hpp"
#include "plugin/simulate_options.hpp"

namespace wems::plugin {

namespace {

std::string accepted(Quantity quantity) {
    return std::string("axes and values such as z=200 or x=100,y=100; units: ") + listUnits(quantity);
}

std::vector<std::string> split(const std::string& text) {
    std::vector<std::string> parts;
    std::stringstream stream(text);
    for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
    if (text.empty() || text.back() == ',') parts.emplace_back();
    return parts;
}

int findAxis(const std::string& name) {
    return name.size() == 1 && name[0] >= 'x' && name[0] <= 'z' ? name[0] - 'x' : -1;
}

}  // namespace

double parseQuantity(const std::string& text, Quantity quantity, const std::string& option, bool* with_unit) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (end == text.c_str() || !std::isfinite(value))
        throw InputError({"", 0, option}, "`" + text + "` is not a number", accepted(quantity));
    const std::string unit = end;
    if (unit.empty()) return value;
    if (with_unit != nullptr) *with_unit = true;
    return value * findUnitFactor(unit, quantity, {"", 0, option});
}

Level parseLevel(const std::string& text, const std::string& option, Quantity quantity) {
    Level level;
    std::set<int> given;
    for (const std::string& part : split(text)) {
        const auto equals = part.find('=');
        const int axis = findAxis(part.substr(0, equals));
        if (axis < 0) throw InputError({"", 0, option}, "`" + part + "` is not understood", accepted(quantity));
        if (!given.insert(axis).second)
            throw InputError({"", 0, option}, "`" + part.substr(0, 1) + "` is given twice", accepted(quantity));
        if (equals == std::string::npos) {
            level.bare = true;
            level.value[axis] = 1;
        } else {
            level.value[axis] = parseQuantity(part.substr(equals + 1), quantity, option, &level.with_unit);
        }
    }
    if (level.value.isZero()) throw InputError({"", 0, option}, "excites nothing", accepted(quantity));
    return level;
}

std::vector<Level> parseLevels(const std::string& text, const std::string& option, Quantity quantity) {
    const std::vector<std::string> parts = split(text);
    bool list = parts.size() > 1 && parts[0].find('=') != std::string::npos;
    for (std::size_t i = 1; i < parts.size(); ++i) list = list && parts[i].find('=') == std::string::npos;
    if (!list) return {parseLevel(text, option, quantity)};
    std::vector<Level> levels;
    const std::string axis = parts[0].substr(0, parts[0].find('=') + 1);
    for (std::size_t i = 0; i < parts.size(); ++i)
        levels.push_back(parseLevel(i == 0 ? parts[i] : axis + parts[i], option, quantity));
    return levels;
}

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

namespace {

std::string formatVector(const Eigen::Vector3d& v) {
    std::string text;
    for (int i = 0; i < 3; ++i)
        if (v[i] != 0) text += (text.empty() ? "" : ",") + std::string(1, "xyz"[i]) + "=" + formatNumber(v[i]);
    return text;
}

/// k/rate for all k with k/rate ≤ duration.
SampleTimes makeUniformTimes(double rate, double duration) {
    const double count = std::floor(duration * rate * (1 + 1e-12)) + 1;
    if (!(count < 5e8))
        throw InputError({"", 0, "--sample-rate"}, "gives " + formatNumber(count, 3) + " samples", "fewer than 5e8");
    return SampleTimes::makeUniform(rate, static_cast<std::size_t>(count));
}

/// Hz.
double chooseSampleRate(double highest) {
    constexpr double usual = 1000, fewest_per_period = 2.5, chosen_per_period = 5;
    if (usual >= fewest_per_period * highest) return usual;
    return std::ceil(chosen_per_period * highest / usual) * usual;
}

}  // namespace

Excitation makeReplay(Recording recording, const SimulateOptions& options, const std::vector<SensorFault>& sensors) {
    // A channel that is not replayed may be dead.
    std::vector<SensorFault> of_drive;
    std::copy_if(sensors.begin(), sensors.end(), std::back_inserter(of_drive), [](const SensorFault& sensor) {
        return sensor.channel.rfind("load", 0) == 0 || sensor.channel.rfind("base", 0) == 0;
    });
    recording = correctChannels(recording, of_drive);
    Excitation excitation;
    excitation.drive = makeReplayDrive(recording);
    excitation.time_offset = recording.time.front();
    excitation.description = "replay of " + options.replay_file;
    excitation.level = excitation.drive->hasLoad() ? "recorded load" : "recorded base acceleration";
    const double duration = std::min(excitation.drive->duration(), options.duration.value_or(INFINITY));
    if (options.sample_rate) {
        excitation.times = makeUniformTimes(*options.sample_rate, duration);
    } else {
        for (const double t : recording.time)
            if (t - recording.time.front() <= duration) excitation.times.push_back(t - recording.time.front());
    }
    return excitation;
}

Excitation makeExcitation(const SimulateOptions& options, const std::vector<SensorFault>& sensors) {
    if (!options.replay_file.empty()) {
        std::optional<ColumnMap> map;
        if (!options.column_map.empty()) map = readColumnMap(options.column_map);
        return makeReplay(readRecording(options.replay_file, map ? &*map : nullptr), options, sensors);
    }
    NamedSignal named = options.kind->make(options.signal, options);
    Excitation excitation;
    const bool travel = !options.base_displacement.isZero();
    if (travel) {
        if (!named.swept)
            throw InputError({"", 0, "--base-displacement"}, std::string("does not go with ") + options.kind->option,
                             "--sweep or --dwell");
        named.signal = makeDisplacementDriven(named.signal);
    }
    const Eigen::Vector3d base = options.base_acceleration + options.base_displacement;  // one of them is zero
    excitation.drive = makeSignalDrive(named.signal, options.force, base, named.swept);
    excitation.description = named.description;
    // Without a unit the level of a spectrum is a factor.
    const bool factor = options.kind->takes_bare_level && !options.level_has_unit;
    excitation.level = options.force.isZero()
                           ? "base acceleration " + formatVector(options.base_acceleration) + (factor ? "" : " m/s^2")
                           : "force " + formatVector(options.force) + (factor ? "" : " N");
    if (travel) excitation.level = "base displacement " + formatVector(options.base_displacement) + " m";
    const double duration = std::min(named.signal->duration(), options.duration.value_or(INFINITY));
    excitation.times =
        makeUniformTimes(options.sample_rate.value_or(chooseSampleRate(named.signal->highestFrequency())), duration);
    return excitation;
}

}  // namespace wems::plugin
