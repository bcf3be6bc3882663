// identify compare: errors of a simulated recording, channel by channel, by frequency band and by regime.
#include <iostream>
#include <memory>
#include <optional>

#include "identify/cli/command.hpp"
#include "identify/commands/compare.hpp"
#include "models/command_line/usage.hpp"
#include "models/recording/recording_reader.hpp"

namespace wems::identify::cli {
namespace {

struct CompareArguments {
    CommonOptions common;
    CompareRequest request;
    std::optional<double> limit;
};

void answerCompare(CompareArguments& arguments, int& exit_status) {
    const CommonOptions& common = arguments.common;
    arguments.request.columns = common.column_map;
    arguments.request.geometry = common.geometry;
    OutputFiles outputs;
    TerminalWatcher watcher("", common, outputs);
    const CompareAnswer answer = runCompare(arguments.request, watcher);
    watcher.close();
    for (const auto& warning : answer.warnings) std::cerr << "identify: " << warning << "\n";
    if (common.printsText()) std::cout << formatText(answer, outputStyle());
    if (!common.json_file.empty()) writeJson(toJson(answer), common, outputs);
    if (!common.report_file.empty()) writeReport(answer, common.report_file, outputs);
    finishOutput(outputs);
    const double error = answer.comparison.error;
    if (!arguments.limit || error <= *arguments.limit) return;
    std::cerr << "identify: the error " << formatNumber(error, 4) << " exceeds the limit "
              << formatNumber(*arguments.limit, 4) << "\n";
    exit_status = 1;
}

}  // namespace

void addCompareCommand(CLI::App& app, int& exit_status) {
    auto* command = app.add_subcommand("compare", "Errors of a simulated recording against a measured one");
    auto options = std::make_shared<CompareArguments>();
    addInputFile(*command, "measured", options->request.measured,
                 std::string("recording of the test (") + kReadableFormats + ")")
        ->required();
    addInputFile(*command, "simulated", options->request.simulated, "recording of the simulation")->required();
    addInputFile(*command, "--model", options->request.model,
                 "mount model: exact relative displacements, and errors free and in contact apart");
    command->add_option("--limit", options->limit, "exit status 1 if the error exceeds this fraction, such as 0.05")
        ->check(isPositive());
    addCommonOptions(*command, options->common);
    addGeometryOption(*command, options->common);
    command->footer("Example:\n  identify compare measured.csv simulated.csv --model mount.toml --limit 0.05");
    command->callback([options, &exit_status] { answerCompare(*options, exit_status); });
}

}  // namespace wems::identify::cli
