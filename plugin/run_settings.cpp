#include "plugin/run_settings.hpp"

#include <cmath>
#include <string>

#include "models/format_number.hpp"
#include "plugin/simbody.hpp"

namespace wems::plugin {
namespace {

std::string simbodyVersion() {
    int major = 0, minor = 0, build = 0;
    SimTK_version_simbody(&major, &minor, &build);
    return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(build);
}

std::string describeNoise(const SensorNoise& noise) {
    std::string text;
    const auto add = [&](const char* name, double level, const char* unit) {
        if (level > 0) text += (text.empty() ? "" : ", ") + std::string(name) + " " + formatNumber(level) + " " + unit;
    };
    add("displacement", noise.displacement, "m");
    add("velocity", noise.velocity, "m/s");
    add("acceleration", noise.acceleration, "m/s^2");
    add("load", noise.load, "N");
    add("base", noise.base, "m/s^2");
    return text.empty() ? "none" : text + " RMS";
}

}  // namespace

SimulationSettings makeSettings(const SimulateOptions& options, const Excitation& excitation) {
    SimulationSettings settings;
    settings.times = excitation.times;
    settings.channels = options.channels;
    settings.noise = options.noise;
    settings.seed = options.seed;
    settings.accuracy = options.accuracy;
    // Reports are interpolated between steps, and where no stop is touched the error control sleeps.
    constexpr double steps_per_period = 12;
    if (options.replay_file.empty())
        settings.longest_step =
            std::fmin(settings.longest_step, 1 / (steps_per_period * excitation.drive->highestFrequency()));
    return settings;
}

Recording makeHeader(const SimulateOptions& options, const MountModel& model, const Excitation& excitation,
                     const std::vector<SensorChannel>& channels) {
    Recording header = makeRecordingHeader(channels);
    header.metadata = {{"program", "wems simulate " WEMS_VERSION},
                       {"simbody", simbodyVersion()},
                       {"model", model.name + " (" + options.model_file + ")"},
                       {"excitation", excitation.description},
                       {"level", excitation.level},
                       {"noise", describeNoise(options.noise)},
                       {"seed", std::to_string(options.seed)},
                       {"accuracy", formatNumber(options.accuracy)}};
    return header;
}

}  // namespace wems::plugin
