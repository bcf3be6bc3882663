// identify diagnose: what the simulation gets wrong, the named causes, the extended model, the gain.
#include <iostream>
#include <memory>

#include "identify/cli/command.hpp"
#include "identify/commands/diagnose.hpp"
#include "identify/commands/fit_output.hpp"
#include "models/command_line/usage.hpp"
#include "models/recording/recording_reader.hpp"

namespace wems::identify::cli {
namespace {

struct DiagnoseArguments {
    CommonOptions common;
    DiagnoseRequest request;
    std::string output;
    std::vector<std::string> fail_on;
};

void answerDiagnose(DiagnoseArguments& arguments, int& exit_status) {
    const CommonOptions& common = arguments.common;
    arguments.request.runs.columns = common.column_map;
    arguments.request.runs.geometry = common.geometry;
    OutputFiles outputs;
    TerminalWatcher watcher(arguments.output, common, outputs);
    const DiagnoseAnswer answer = runDiagnosis(arguments.request, watcher);
    if (!arguments.output.empty()) addFittedModel(answer.extended, arguments.output, outputs);
    if (!common.report_file.empty()) {
        watcher.onStep("report");
        writeReport(answer, common.report_file, outputs);
    }
    watcher.close();
    for (const auto& warning : answer.warnings) std::cerr << "identify: " << warning << "\n";
    if (!common.json_file.empty()) writeJson(toJson(answer), common, outputs);
    if (common.printsText()) {
        std::cout << formatText(answer, outputStyle());
        if (!arguments.output.empty()) {
            std::cout << "\nExtended model: " << arguments.output << "\n";
            for (const auto& note : answer.notes) std::cout << "note: " << note << "\n";
        }
    }
    finishOutput(outputs);
    failOn(arguments.fail_on, formatVerdict(answer.diagnosis.verdict), exit_status);
}

}  // namespace

void addDiagnoseCommand(CLI::App& app, int& exit_status) {
    auto arguments = std::make_shared<DiagnoseArguments>();
    auto* command = app.add_subcommand("diagnose", "Find what the model lacks or has wrong, and extend it");
    addInputFile(*command, "runs", arguments->request.runs.recordings,
                 std::string("recordings to identify from (") + kReadableFormats + ")");
    addInputFile(*command, "--test", arguments->request.runs.test,
                 "TOML that lists the runs of a test and their roles");
    addInputFile(*command, "--model", arguments->request.runs.model,
                 "mount model (TOML); required unless the test file names one");
    addInputFile(*command, "--validate", arguments->request.runs.validation,
                 "recordings that judge the causes; never fitted to, so other runs than those above");
    addOutputFile(*command, "-o,--output", arguments->output, "write the extended model to FILE (TOML)");
    addFailOption(*command, arguments->fail_on, {"explained", "nothing_missing", "unexplained"});
    addCommonOptions(*command, arguments->common);
    addGeometryOption(*command, arguments->common);
    command->footer(
        "Examples:\n"
        "  identify diagnose run1.csv run2.csv --model mount.toml --validate run3.csv -o extended.toml\n"
        "  identify diagnose --test campaign.toml --json causes.json --report causes.html");
    command->callback([arguments, &exit_status] { answerDiagnose(*arguments, exit_status); });
}

}  // namespace wems::identify::cli
