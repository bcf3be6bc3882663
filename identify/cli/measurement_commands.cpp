// identify inspect: what is in a recording, what is suspicious, what can be identified from it.
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include "identify/cli/command.hpp"
#include "identify/commands/inspect.hpp"
#include "identify/commands/rigidity.hpp"
#include "identify/commands/spectra.hpp"
#include "models/command_line/usage.hpp"
#include "models/common/error.hpp"
#include "models/recording/recording_reader.hpp"

namespace wems::identify::cli {

namespace {

struct InspectArguments {
    CommonOptions common;
    InspectRequest request;
    std::vector<std::string> fail_on;
    bool strict = false;
};

void answerInspect(InspectArguments& arguments, int& exit_status) {
    const CommonOptions& common = arguments.common;
    arguments.request.columns = common.column_map;
    arguments.request.geometry = common.geometry;
    OutputFiles outputs;
    TerminalWatcher watcher("", common, outputs);
    const InspectAnswer answer = runInspect(arguments.request, watcher);
    watcher.close();
    if (common.printsText()) std::cout << formatText(answer, outputStyle());
    if (!common.json_file.empty()) writeJson(toJson(answer), common, outputs);
    if (!common.report_file.empty()) writeReport(answer, common.report_file, outputs);
    finishOutput(outputs);
    if (arguments.strict && answer.hasFindings()) exit_status = 1;
    for (const InspectedRecording& one : answer.recordings)
        failOn(arguments.fail_on, qualityName(one.inspection.quality.quality), exit_status);
}

}  // namespace

void addInspectCommand(CLI::App& app, int& exit_status) {
    auto* command = app.add_subcommand("inspect", "Show what is in recordings and what is suspicious about them");
    auto options = std::make_shared<InspectArguments>();
    addInputFile(*command, "recordings", options->request.recordings,
                 std::string("recordings (") + kReadableFormats + ")")
        ->required();
    addInputFile(*command, "--model", options->request.model,
                 "mount model: also finds missing and exchanged connections");
    command->add_flag("--strict", options->strict, "exit status 1 if anything is suspicious");
    addFailOption(*command, options->fail_on, {"doubtful", "unusable"});
    addCommonOptions(*command, options->common);
    addGeometryOption(*command, options->common);
    addMemoryOption(*command, options->request.memory);
    command->footer("Example:\n  identify inspect run1.csv run2.mat --model mount.toml --report runs.html");
    command->callback([options, &exit_status] { answerInspect(*options, exit_status); });
}

// identify rigidity: does each part of a recording move as a rigid body?

namespace {

struct RigidityArguments {
    CommonOptions common;
    RigidityRequest request;
    std::optional<double> limit;
    std::vector<std::string> fail_on;
};

void answerRigidity(RigidityArguments& arguments, int& exit_status) {
    const CommonOptions& common = arguments.common;
    arguments.request.columns = common.column_map;
    arguments.request.geometry = common.geometry;
    OutputFiles outputs;
    TerminalWatcher watcher("", common, outputs);
    const RigidityAnswer answer = runRigidity(arguments.request, watcher);
    if (!common.report_file.empty()) {
        watcher.onStep({"report", 0.6, 1});
        writeReport(answer, common.report_file, outputs);
    }
    watcher.close();
    if (common.printsText()) std::cout << formatText(answer, outputStyle());
    if (!common.json_file.empty()) writeJson(toJson(answer), common, outputs);
    finishOutput(outputs);
    if (arguments.limit && answer.findLargest() > *arguments.limit) exit_status = 1;
    failOn(arguments.fail_on, qualityName(answer.quality.quality), exit_status);
}

}  // namespace

void addRigidityCommand(CLI::App& app, int& exit_status) {
    CLI::App* command = app.add_subcommand("rigidity", "Check that each part of a recording moves as a rigid body");
    const auto options = std::make_shared<RigidityArguments>();
    addInputFile(*command, "recording", options->request.recording, std::string("recording (") + kReadableFormats + ")")
        ->required();
    addInputFile(*command, "--model", options->request.model, "mount model (TOML)")->required();
    command->add_option("--limit", options->limit, "exit status 1 if a check exceeds this, in percent")
        ->check(isNonNegative());
    addFailOption(*command, options->fail_on, {"doubtful", "unusable"});
    addCommonOptions(*command, options->common);
    addGeometryOption(*command, options->common);
    command->footer("Example:\n  identify rigidity run.csv --model smallsat.toml --limit 0.5 --json rigidity.json");
    command->callback([options, &exit_status] { answerRigidity(*options, exit_status); });
}

// identify spectra: frequency responses, densities, orders, shock response and margins of recordings.

namespace {

struct SpectraArguments {
    CommonOptions common;
    SpectraRequest request;
    std::string band;
};

std::pair<double, double> parseBand(const std::string& text) {
    double from = 0, to = 0;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%lf:%lf%c", &from, &to, &rest) != 2 || !(from > 0 && to > from))
        throw InputError({"", 0, "--band"}, "`" + text + "` is not understood",
                         "two ascending frequencies in Hz, such as 5:50");
    return {from, to};
}

void answerSpectra(SpectraArguments& arguments) {
    const CommonOptions& common = arguments.common;
    SpectraRequest& request = arguments.request;
    request.columns = common.column_map;
    request.geometry = common.geometry;
    if (!arguments.band.empty()) request.settings.band = parseBand(arguments.band);
    OutputFiles outputs;
    TerminalWatcher watcher("", common, outputs);
    const SpectraAnswer answer = runSpectra(request, watcher);
    watcher.close();
    for (const auto& warning : answer.warnings) std::cerr << "identify: " << warning << "\n";
    if (common.printsText()) std::cout << formatText(answer, outputStyle());
    if (!common.json_file.empty()) writeJson(toJson(answer), common, outputs);
    if (!common.report_file.empty()) writeReport(answer, common.report_file, outputs);
    finishOutput(outputs);
}

}  // namespace

void addSpectraCommand(CLI::App& app, int& /*exit_status*/) {
    auto* command = app.add_subcommand(
        "spectra",
        "Transmissibility, frequency response, power and shock spectra, orders, strokes and clearances left");
    auto options = std::make_shared<SpectraArguments>();
    addInputFile(*command, "recordings", options->request.recordings,
                 std::string("recordings (") + kReadableFormats + "); several are overlaid in the report")
        ->required();
    addInputFile(*command, "--model", options->request.model,
                 "mount model: forces of the connections and clearances left");
    command->add_option("--reference", options->request.settings.reference,
                        "channel that drives (absent: the strongest of load, base, fixed part)");
    command
        ->add_option("--resolution", options->request.settings.resolution,
                     "Hz from one line to the next (absent: 20 segments)")
        ->check(isPositive());
    command->add_option("--band", options->band, "f0:f1 in Hz, where peaks are looked for (absent: what is excited)");
    command
        ->add_option("--q", options->request.settings.quality,
                     "quality factor Q of the shock response spectrum (default 10)")
        ->check(CLI::Validator(
            [](std::string& text) {
                return std::atof(text.c_str()) > 0.5 ? std::string() : "'" + text + "' is not above 0.5";
            },
            "ABOVE 0.5"));
    addCommonOptions(*command, options->common);
    addGeometryOption(*command, options->common);
    command->footer(
        "Example, three levels of one test overlaid, with what is left of each clearance:\n"
        "  identify spectra low.csv middle.csv high.csv --model mount.toml --report spectra.html");
    command->callback([options] { answerSpectra(*options); });
}

}  // namespace wems::identify::cli
