#include <cmath>
#include <cstdlib>
#include <sstream>

#include "models/error.hpp"
#include "models/format_number.hpp"
#include "models/recording/recording_reader.hpp"
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

std::string formatVector(const Eigen::Vector3d& v) {
    std::string text;
    for (int i = 0; i < 3; ++i)
        if (v[i] != 0) text += (text.empty() ? "" : ",") + std::string(1, "xyz"[i]) + "=" + formatNumber(v[i]);
    return text;
}

/// k/rate for all k with k/rate ≤ duration.
std::vector<double> makeUniformTimes(double rate, double duration) {
    const double count = std::floor(duration * rate * (1 + 1e-12)) + 1;
    if (count > 5e8)
        throw InputError({"", 0, "--sample-rate"}, "gives " + formatNumber(count, 3) + " samples", "fewer than 5e8");
    std::vector<double> times(static_cast<std::size_t>(count));
    for (std::size_t k = 0; k < times.size(); ++k) times[k] = static_cast<double>(k) / rate;
    return times;
}

struct NamedSignal {
    std::shared_ptr<const Signal> signal;
    bool swept;
    std::string description;
};

NamedSignal makeSignal(const SimulateOptions& options) {
    const Fade fade{options.fade, options.fade};
    if (!options.sweep.empty()) {
        const auto f = parseColons(options.sweep, 2, "--sweep", "two frequencies in Hz, such as 5:50");
        const std::string range = "sine sweep " + formatNumber(f[0]) + " to " + formatNumber(f[1]) + " Hz, ";
        if (options.hertz_per_second)
            return {makeLinearSweep(f[0], f[1], *options.hertz_per_second, fade), true,
                    range + formatNumber(*options.hertz_per_second) + " Hz per second"};
        const double rate = options.octaves_per_minute.value_or(4);
        return {makeLogarithmicSweep(f[0], f[1], rate, fade), true, range + formatNumber(rate) + " octaves per minute"};
    }
    if (!options.dwell.empty()) {
        const auto f = parseColons(options.dwell, 2, "--dwell", "frequency in Hz and duration in s, such as 30:10");
        return {makeDwell(f[0], f[1], fade), true,
                "dwell at " + formatNumber(f[0]) + " Hz, " + formatNumber(f[1]) + " s"};
    }
    const auto f = parseColons(options.random, 3, "--random", "band in Hz and duration in s, such as 5:50:60");
    return {makeBandLimitedRandom(f[0], f[1], f[2], options.seed, fade), false,
            "random " + formatNumber(f[0]) + " to " + formatNumber(f[1]) + " Hz, " + formatNumber(f[2]) + " s"};
}

Excitation makeReplay(const SimulateOptions& options) {
    std::optional<ColumnMap> map;
    if (!options.column_map.empty()) map = readColumnMap(options.column_map);
    const Recording recording = readRecording(options.replay_file, map ? &*map : nullptr);
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

}  // namespace

Excitation makeExcitation(const SimulateOptions& options) {
    if (!options.replay_file.empty()) return makeReplay(options);
    const NamedSignal named = makeSignal(options);
    Excitation excitation;
    excitation.drive = makeSignalDrive(named.signal, options.force, options.base_acceleration, named.swept);
    excitation.description = named.description;
    excitation.level = options.force.isZero()
                           ? "base acceleration " + formatVector(options.base_acceleration) + " m/s^2"
                           : "force " + formatVector(options.force) + " N";
    const double duration = std::min(named.signal->duration(), options.duration.value_or(INFINITY));
    excitation.times = makeUniformTimes(options.sample_rate.value_or(1000), duration);
    return excitation;
}

}  // namespace wems::plugin
