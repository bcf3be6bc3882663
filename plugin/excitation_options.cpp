#include <cmath>

#include "models/error.hpp"
#include "models/format_number.hpp"
#include "models/recording/recording_reader.hpp"
#include "plugin/excitation_kinds.hpp"
#include "plugin/simulate_options.hpp"

namespace wems::plugin {
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
