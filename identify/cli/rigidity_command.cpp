// identify rigidity: does each part of a recording move as a rigid body?
#include <iostream>
#include <memory>
#include <optional>

#include "identify/cli/command.hpp"
#include "identify/commands/rigidity.hpp"
#include "models/command_line/usage.hpp"
#include "models/recording/recording_reader.hpp"

namespace wems::identify::cli {
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
        watcher.onStep("report", 0.6, 1);
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

}  // namespace wems::identify::cli
