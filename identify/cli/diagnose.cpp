// `identify diagnose`: what the simulation gets wrong, the named causes, the extended model, the gain.
#include <cmath>
#include <iostream>
#include <memory>

#include "identify/cli/campaign.hpp"
#include "identify/cli/command.hpp"
#include "identify/cli/device_scene.hpp"
#include "identify/cli/diagnosis_output.hpp"
#include "identify/cli/diagnosis_report.hpp"
#include "identify/cli/recordings.hpp"
#include "identify/diagnose/diagnosis.hpp"
#include "models/progress.hpp"

namespace wems::identify::cli {
namespace {

struct DiagnoseArguments {
    CommonOptions common;
    RunSelection runs;
    std::string output;
};

void runDiagnose(DiagnoseArguments arguments) {
    resolveRuns(arguments.runs, arguments.common);
    const MountModel model = readDeviceModel(arguments.runs.model, arguments.common.geometry);
    std::optional<Progress> progress(std::in_place, !arguments.common.quiet);
    progress->step("reading");
    const auto identification = readDeviceRecordings(arguments.runs.recordings, arguments.common.column_map, model);
    const auto validation = readDeviceRecordings(arguments.runs.validation, arguments.common.column_map, model);
    DiagnosisOptions options;
    options.progress = [&](const std::string& text) { progress->step(text); };
    const Diagnosis diagnosis = diagnose(identification, validation, model, options);
    progress.reset();
    if (!arguments.output.empty()) writeMountModel(diagnosis.extended, arguments.output);
    writeJson(makeDiagnosisJson(diagnosis), arguments.common);
    if (!arguments.common.report_file.empty())
        writeDiagnosisReport(diagnosis, model.name.empty() ? arguments.runs.model : model.name,
                             makeDeviceScene(identification, diagnosis.extended), arguments.common.report_file);
    if (arguments.common.printsText()) {
        for (const auto* group : {&identification, &validation})
            for (const auto& recording : *group)
                for (const auto& warning : recording.warnings) std::cout << recording.file << ": " << warning << "\n";
        std::cout << formatDiagnosis(diagnosis, outputStyle());
        if (!arguments.output.empty()) std::cout << "\nExtended model: " << arguments.output << "\n";
    }
}

}  // namespace

void addDiagnoseCommand(CLI::App& app, int&) {
    auto arguments = std::make_shared<DiagnoseArguments>();
    auto* command = app.add_subcommand("diagnose", "Find what the model lacks or has wrong, and extend it");
    command->add_option("runs", arguments->runs.recordings,
                        "recordings to identify from (CSV, MATLAB, UFF 58, OpenSim)");
    command->add_option("--test", arguments->runs.test, "TOML that lists the runs of a test and their roles");
    command->add_option("--model", arguments->runs.model, "mount model (TOML)");
    command->add_option("--validate", arguments->runs.validation, "recordings that judge; never fitted to");
    command->add_option("-o,--output", arguments->output, "write the extended model to FILE (TOML)");
    addCommonOptions(*command, arguments->common);
    addGeometryOption(*command, arguments->common);
    command->footer(
        "Example:\n  identify diagnose run1.csv run2.csv --model mount.toml --validate run3.csv -o extended.toml");
    command->callback([arguments] { runDiagnose(*arguments); });
}

}  // namespace wems::identify::cli
