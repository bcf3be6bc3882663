// identify fit: stiffness, clearance, stop stiffness and damping of each connection and axis, with intervals.
#include <iostream>
#include <memory>

#include "identify/cli/command.hpp"
#include "identify/commands/fit.hpp"
#include "identify/commands/fit_output.hpp"
#include "models/command_line/usage.hpp"
#include "models/recording/recording_reader.hpp"

namespace wems::identify::cli {
namespace {

struct FitArguments {
    CommonOptions common;
    FitRequest request;
    std::string output, axis;
    std::vector<std::string> fail_on;
};

void answerFit(FitArguments& arguments, int& exit_status) {
    const CommonOptions& common = arguments.common;
    FitRequest& request = arguments.request;
    request.runs.columns = common.column_map;
    request.runs.geometry = common.geometry;
    request.wants_model = !arguments.output.empty();
    request.keeps_runs = !common.report_file.empty();
    if (!arguments.axis.empty()) request.component.axis = static_cast<int>(std::string("xyz").find(arguments.axis));
    OutputFiles outputs;
    TerminalWatcher watcher(arguments.output, common, outputs);
    const FitAnswer answer = runFit(request, watcher);
    if (!arguments.output.empty()) addFittedModel(answer.fitted, arguments.output, outputs);
    if (!common.report_file.empty()) {
        watcher.onStep("report");
        writeReport(answer, common.report_file, outputs);
    }
    watcher.close();
    if (common.printsText()) std::cout << formatText(answer, outputStyle());
    if (!common.json_file.empty()) writeJson(toJson(answer), common, outputs);
    finishOutput(outputs);
    failOn(arguments.fail_on, answer.verdict(), exit_status);
}

}  // namespace

void addFitCommand(CLI::App& app, int& exit_status) {
    auto* command = app.add_subcommand("fit", "Stiffness, clearance, stops and damping, each with its 95 % interval");
    const auto options = std::make_shared<FitArguments>();
    addInputFile(*command, "recordings", options->request.runs.recordings,
                 std::string("recordings of one device or element (") + kReadableFormats + ")");
    addInputFile(*command, "--test", options->request.runs.test,
                 "TOML that lists the runs of a test; those of role validate judge the fitted model");
    addInputFile(*command, "--model", options->request.runs.model,
                 "mount model to start from (TOML); required unless the test file names one");
    addOutputFile(*command, "-o,--output", options->output,
                  "write the model with the identified values to FILE (TOML)");
    command->add_option(
        "--free", options->request.fit.free_body,
        "also identify body.center_of_gravity, body.inertia, or one component such as body.inertia.Ixx");
    addInputFile(*command, "--validate", options->request.runs.validation,
                 "recordings that judge the fitted model or law; never fitted to");
    command
        ->add_option("--use", options->request.use,
                     "channels of both parts to use: all, displacements or accelerations alone")
        ->check(CLI::IsMember({"all", "displacements", "accelerations"}));
    command->add_flag("--timing", options->request.timing, "show how long each step took");
    addFailOption(*command, options->fail_on, {"identified", "doubtful", "unexplained"});
    addCommonOptions(*command, options->common);
    addGeometryOption(*command, options->common);
    addMemoryOption(*command, options->request.memory);
    const std::string element = "Component test (one element, force measured or a known mass)";
    command->add_option("--connection", options->request.component.connection, "absent: the first one recorded")
        ->group(element);
    command->add_option("--axis", options->axis, "x, y or z; absent: the first one recorded")
        ->check(CLI::IsMember({"x", "y", "z"}))
        ->group(element);
    command
        ->add_option("--mass", options->request.component.mass,
                     "kg; the force is then mass x acceleration of the mobile end")
        ->check(isPositive())
        ->group(element);
    command
        ->add_option("--law", options->request.law,
                     "shape of the law: that of the model, or the one that the tests show (found)")
        ->check(CLI::IsMember({"model", "found"}))
        ->group(element);
    command->add_option("--from", options->request.component.from, "s, start of the window")->group(element);
    command->add_option("--to", options->request.component.to, "s, end of the window")->group(element);
    command->footer(
        "Examples:\n"
        "  identify fit axial.csv oblique.csv --model believed.toml -o fitted.toml --json fit.json\n"
        "  identify fit --test campaign.toml -o fitted.toml\n"
        "  identify fit drop.csv --columns map.toml --model element.toml --mass 0.639 --from 0.40 --to 0.55");
    command->callback([options, &exit_status] { answerFit(*options, exit_status); });
}

}  // namespace wems::identify::cli
