// The executable `simulate`: a mount model under a load or base motion, recorded as CSV or for OpenSim.
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <iostream>

#include "models/atomic_file.hpp"
#include "models/command_line/standard_streams.hpp"
#include "models/error.hpp"
#include "models/format_number.hpp"
#include "models/progress.hpp"
#include "models/recording/recording_writer.hpp"
#include "models/terminal.hpp"
#include "plugin/simulate_options.hpp"
#include "plugin/simulation.hpp"
#include "plugin/summary.hpp"

namespace {

using namespace wems;
using namespace wems::plugin;

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

bool participatesInBaseMotion(const MountModel& model) {
    for (const BracketMode& mode : model.bracket)
        if (!mode.base_participation.isZero()) return true;
    return model.bracket.empty();
}

/// Of a sweep or a dwell; 0 where nothing sweeps.
double findHighestFrequency(const Drive& drive) {
    return std::fmax(0, std::fmax(drive.calcFrequency(0), drive.calcFrequency(drive.duration())));
}

void run(const SimulateOptions& options) {
    const MountModel model = readMountModel(options.model_file);
    OutputFiles outputs;
    const std::vector<std::string> modes{model.bracket_path};
    checkOutputs({options.output_file, options.json_file == "-" ? "" : options.json_file, options.report_file}, modes);
    const Excitation excitation = makeExcitation(options);
    if (excitation.drive->hasBase() && !participatesInBaseMotion(model))
        std::cerr << "simulate: note: the modes file has no base.ux, base.uy, base.uz columns: the base motion shakes "
                     "the mobile part, not the bracket's own mass\n";

    if (const double rate = options.sample_rate.value_or(INFINITY); rate < 2 * findHighestFrequency(*excitation.drive))
        std::cerr
            << "simulate: note: " << formatNumber(rate)
            << " Hz are less than two samples in a period of the excitation: the recording shows other frequencies\n";

    Progress progress(!options.quiet);
    SimulationSettings settings;
    settings.times = excitation.times;
    settings.channels = options.channels;
    settings.noise = options.noise;
    settings.seed = options.seed;
    settings.accuracy = options.accuracy;
    settings.progress = [&](double t) {
        if (!progress.due()) return;
        char what[80];
        std::snprintf(what, sizeof what, "t = %.1f s of %.1f s, %.1f Hz", t, settings.times.back(),
                      excitation.drive->calcFrequency(t));
        progress.show(t / settings.times.back(), what);
    };
    SimulationResult result = simulate(model, excitation.drive, settings);

    for (double& t : result.recording.time) t += excitation.time_offset;
    result.recording.metadata = {{"program", "wems simulate " WEMS_VERSION},
                                 {"simbody", simbodyVersion()},
                                 {"model", model.name + " (" + options.model_file + ")"},
                                 {"excitation", excitation.description},
                                 {"level", excitation.level},
                                 {"noise", describeNoise(options.noise)},
                                 {"seed", std::to_string(options.seed)},
                                 {"accuracy", formatNumber(options.accuracy)}};
    const RunDescription description{model, *excitation.drive, result, excitation.time_offset};
    if (!options.output_file.empty()) {
        WriteOptions write;
        for (const Connection& connection : model.connections) write.rest[connection.name] = connection.position;
        for (const std::string& note : writeRecording(result.recording, options.output_file, write, outputs))
            std::cerr << "simulate: note: " << note << "\n";
    }
    if (!options.report_file.empty()) writeHtmlSummary(description, options.report_file, outputs);
    // Names of files need not be UTF-8.
    const std::string json =
        makeSummaryJson(description).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    const bool data_on_output = options.json_file == "-";
    if (data_on_output) {
        std::cout << json;
    } else if (!options.json_file.empty()) {
        outputs.add(options.json_file, json);
    }
    if (!options.quiet && !data_on_output) std::cout << formatSummary(description, styleOf(STDOUT_FILENO));
    flushStandardOutput();
    outputs.commit();
}

int work(int argc, char** argv) {
    int exit_status = 0;
    const auto options = parseCommandLine(argc, argv, exit_status);
    if (options) run(*options);
    return exit_status;
}

}  // namespace

int main(int argc, char** argv) {
    return runProgram("simulate", work, argc, argv);
}
