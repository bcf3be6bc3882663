// `identify diagnose`: what the simulation gets wrong, the named causes, the extended model, the gain.
#include <algorithm>
#include <iostream>
#include <memory>

#include "identify/cli/campaign.hpp"
#include "identify/cli/command.hpp"
#include "identify/cli/diagnosis_output.hpp"
#include "identify/cli/diagnosis_report.hpp"
#include "identify/cli/fitted_model.hpp"
#include "identify/cli/recordings.hpp"
#include "identify/diagnose/diagnosis.hpp"
#include "models/command_line/usage.hpp"
#include "models/progress.hpp"
#include "models/recording/recording_reader.hpp"

namespace wems::identify::cli {
namespace {

struct DiagnoseArguments {
    CommonOptions common;
    RunSelection runs;
    std::string output;
};

/// When the steps of a diagnosis usually begin, as part of its whole time: as if the present round were the last one,
/// the first one as if it found a cause.
class StepShares {
public:
    /// Zero where it cannot be told.
    double findBegin(const std::string& step) {
        const auto is = [&](const char* name) { return step.rfind(name, 0) == 0; };
        if (is("equations of motion with")) known_ = false;  // all over again
        if (!known_) return 0;
        if (is("round")) ++rounds_;
        if (is("rivals")) ++rivals_;
        const int causes = std::max(1, rounds_ - 1);
        double done = reading, left = one_round + causes * rivals + judging;
        if (is("equations of motion")) {
            left += equations + one_round + adoption;
        } else if (is("round")) {
            done += equations + (rounds_ - 1) * (one_round + adoption);
            if (rounds_ == 1) left += one_round + adoption;
        } else if (is("taken")) {
            done += equations + rounds_ * one_round + (rounds_ - 1) * adoption;
            left += adoption + (rounds_ - causes) * rivals;
        } else if (is("rivals")) {
            done += equations + rounds_ * one_round + (rounds_ - 1) * adoption + (rivals_ - 1) * rivals;
            left = (causes - rivals_ + 1) * rivals + judging;
        } else {
            return 0;
        }
        return done / (done + left);
    }

private:
    // As measured, in units of the time that setting the equations up takes.
    static constexpr double reading = 0.08, equations = 1, one_round = 0.95, adoption = 0.4, rivals = 1.5,
                            judging = 0.1;
    int rounds_ = 0, rivals_ = 0;
    bool known_ = true;
};

void runDiagnose(DiagnoseArguments arguments) {
    OutputFiles outputs;
    resolveRuns(arguments.runs, arguments.common);
    const MountModel model = readDeviceModel(arguments.runs.model, arguments.common.geometry);
    protectInputs(listInputs(arguments.runs, arguments.common, model), arguments.output, arguments.common, outputs);
    for (const std::string& judge : arguments.runs.validation)
        for (const std::string& fitted : arguments.runs.recordings)
            if (judge == fitted)
                std::cerr << "identify: " << judge << " is fitted to and judges too, which flatters every cause\n";
    std::optional<Progress> progress(std::in_place, !arguments.common.quiet);
    progress->step("reading");
    const auto identification = readDeviceRecordings(arguments.runs.recordings, arguments.common.column_map, model);
    const auto validation = readDeviceRecordings(arguments.runs.validation, arguments.common.column_map, model);
    checkFitStart(model, arguments.runs.model);
    for (const auto* group : {&identification, &validation}) {
        checkSampleRate(*group, model);
        checkDisplacements(*group, model);
    }
    DiagnosisOptions options;
    StepShares shares;
    options.progress = [&](const std::string& text) { progress->step(text, shares.findBegin(text)); };
    const Diagnosis diagnosis = diagnose(identification, validation, model, options);
    std::vector<std::string> limited;
    if (!arguments.output.empty()) addFittedModel(model, diagnosis.extended, arguments.output, limited, outputs);
    if (!arguments.common.report_file.empty()) {
        progress->step("report");
        writeDiagnosisReport(diagnosis, model, {identification, validation, readDrawing(arguments.runs.model)},
                             model.name.empty() ? arguments.runs.model : model.name, arguments.common.report_file,
                             outputs);
    }
    progress.reset();
    writeJson(makeDiagnosisJson(diagnosis), arguments.common, outputs);
    if (arguments.common.printsText()) {
        for (const auto* group : {&identification, &validation})
            for (const auto& recording : *group)
                for (const auto& warning : recording.warnings) std::cout << recording.file << ": " << warning << "\n";
        std::cout << formatDiagnosis(diagnosis, outputStyle());
        if (!arguments.output.empty()) std::cout << "\nExtended model: " << arguments.output << "\n";
        for (const auto& note : limited) std::cout << "note: " << note << "\n";
    }
    finishOutput(outputs);
}

}  // namespace

void addDiagnoseCommand(CLI::App& app, int&) {
    auto arguments = std::make_shared<DiagnoseArguments>();
    auto* command = app.add_subcommand("diagnose", "Find what the model lacks or has wrong, and extend it");
    addInputFile(*command, "runs", arguments->runs.recordings,
                 std::string("recordings to identify from (") + kReadableFormats + ")");
    addInputFile(*command, "--test", arguments->runs.test, "TOML that lists the runs of a test and their roles");
    addInputFile(*command, "--model", arguments->runs.model,
                 "mount model (TOML); required unless the test file names one");
    addInputFile(*command, "--validate", arguments->runs.validation,
                 "recordings that judge the causes; never fitted to, so other runs than those above");
    addOutputFile(*command, "-o,--output", arguments->output, "write the extended model to FILE (TOML)");
    addCommonOptions(*command, arguments->common);
    addGeometryOption(*command, arguments->common);
    command->footer(
        "Examples:\n"
        "  identify diagnose run1.csv run2.csv --model mount.toml --validate run3.csv -o extended.toml\n"
        "  identify diagnose --test campaign.toml --json causes.json --report causes.html");
    command->callback([arguments] { runDiagnose(*arguments); });
}

}  // namespace wems::identify::cli
