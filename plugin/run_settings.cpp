#include "plugin/run_settings.hpp"

#include <cmath>
#include <optional>
#include <string>

#include "models/common/format_number.hpp"
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

nlohmann::json listAxes(const Eigen::Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}

template <class Value>
nlohmann::json valueOrNull(const std::optional<Value>& value) {
    return value ? nlohmann::json(*value) : nlohmann::json();
}

nlohmann::json describeRun(const SimulateOptions& options) {
    const SensorNoise& noise = options.noise;
    auto channels = nlohmann::json::array();
    if (options.channels.displacement) channels.emplace_back("displacement");
    if (options.channels.velocity) channels.emplace_back("velocity");
    if (options.channels.acceleration) channels.emplace_back("acceleration");
    return {{"base_displacement", listAxes(options.base_displacement)},
            {"octaves_per_minute", valueOrNull(options.octaves_per_minute)},
            {"hertz_per_second", valueOrNull(options.hertz_per_second)},
            {"downwards", options.downwards},
            {"q", valueOrNull(options.quality)},
            {"fade", options.fade},
            {"duration", valueOrNull(options.duration)},
            {"sample_rate", valueOrNull(options.sample_rate)},
            {"channels", channels},
            {"noise",
             {{"displacement", noise.displacement},
              {"velocity", noise.velocity},
              {"acceleration", noise.acceleration},
              {"load", noise.load},
              {"base", noise.base}}},
            {"seed", options.seed},
            {"accuracy", options.accuracy}};
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

ResultRecord makeRecord(const SimulateOptions& options, const std::string& command, const MountModel& model,
                        bool in_memory) {
    ResultRecord record;
    record.program = "wems simulate " WEMS_VERSION;
    record.command = command;
    record.addInput("model", in_memory ? model.name : options.model_file, in_memory);
    record.addInput("bracket modes", in_memory ? "" : model.bracket_path);
    if (options.kind != nullptr && std::string(options.kind->form) == "FILE")
        record.addInput("excitation", options.signal);
    record.addInput("recording", options.replay_file);
    record.addInput("columns", options.column_map);
    if (command == "simulate") record.options = describeRun(options);
    if (command == "modes") record.options["frf"] = options.band;
    if (command == "response") {
        record.options["response"] = options.response;
        record.options["harmonics"] = options.harmonics;
        return record;  // its levels stand with their curves
    }
    record.options["excitation"] = options.kind != nullptr ? options.kind->option + 2 : "";
    record.options["signal"] = options.signal;
    record.options["force"] = listAxes(options.force);
    record.options["base_acceleration"] = listAxes(options.base_acceleration);
    return record;
}

}  // namespace wems::plugin
