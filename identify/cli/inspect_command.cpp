// identify inspect: what is in a recording, what is suspicious, what can be identified from it.
#include <iostream>
#include <memory>

#include "identify/cli/command.hpp"
#include "identify/commands/inspect.hpp"
#include "models/command_line/usage.hpp"
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

}  // namespace wems::identify::cli
