// The executable `simulate`: a mount model under a load or base motion, recorded as CSV or for OpenSim.
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <exception>
#include <iostream>

#include "models/atomic_file.hpp"
#include "models/error.hpp"
#include "models/format_number.hpp"
#include "models/progress.hpp"
#include "models/recording/recording_writer.hpp"
#include "models/terminal.hpp"
#include "plugin/linear_command.hpp"
#include "plugin/response_command.hpp"
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

/// A replay has the samples that it has.
void noteSampleRate(const SimulateOptions& options, const Excitation& excitation) {
    if (!options.replay_file.empty() || excitation.times.size() < 2) return;
    const double rate = 1 / (excitation.times[1] - excitation.times[0]);
    const double highest = excitation.drive->highestFrequency();
    if (rate < 2 * highest)
        std::cerr << "simulate: note: " << formatNumber(rate, 6)
                  << " Hz are less than two samples in a period of the excitation, which reaches "
                  << formatNumber(highest, 4) << " Hz: the recording shows other frequencies; --sample-rate "
                  << formatNumber(5 * highest, 4) << " would show it\n";
}

void run(const SimulateOptions& options) {
    if (!options.response.empty()) return runResponseCurves(options);
    if (options.isLinear()) return runLinearAnalysis(options);
    const MountModel model = readMountModel(options.model_file);
    const Excitation excitation = makeExcitation(options);
    if (excitation.drive->hasBase() && !participatesInBaseMotion(model))
        std::cerr << "simulate: note: the modes file has no base.ux, base.uy, base.uz columns: the base motion shakes "
                     "the mobile part, not the bracket's own mass\n";

    noteSampleRate(options, excitation);

    Progress progress(!options.quiet);
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
        for (const std::string& note : writeRecording(result.recording, options.output_file, write))
            std::cerr << "simulate: note: " << note << "\n";
    }
    if (!options.report_file.empty()) writeHtmlSummary(description, options.report_file);
    // Names of files need not be UTF-8.
    const std::string json =
        makeSummaryJson(description).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    if (options.json_file == "-") {
        std::cout << json;
        return;
    }
    if (!options.json_file.empty()) AtomicFile::write(options.json_file, json);
    if (!options.quiet) std::cout << formatSummary(description, styleOf(STDOUT_FILENO));
}

}  // namespace

int main(int argc, char** argv) {
    try {
        int exit_status = 0;
        const auto options = parseCommandLine(argc, argv, exit_status);
        if (options) run(*options);
        return exit_status;
    } catch (const std::exception& error) {
        std::cerr << "simulate: " << error.what() << "\n";
    }
    return 2;
}
