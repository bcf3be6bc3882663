// identify plan: the next test, which run would tell what the recordings leave open.
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include "identify/cli/command.hpp"
#include "identify/commands/fit_output.hpp"
#include "identify/commands/plan.hpp"
#include "models/command_line/usage.hpp"
#include "models/error.hpp"
#include "models/recording/recording_reader.hpp"

namespace wems::identify::cli {
namespace {

struct PlanArguments {
    CommonOptions common;
    PlanRequest request;
    std::string output, band;
};

std::pair<double, double> parseSweep(const std::string& text) {
    double from = 0, to = 0;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%lf:%lf%c", &from, &to, &rest) != 2 || !(from > 0 && to > from) ||
        !std::isfinite(to))
        throw InputError({"", 0, "--sweep"}, "`" + text + "` is not understood",
                         "two ascending frequencies in Hz, such as 5:50; both directions are tried");
    return {from, to};
}

void answerPlan(PlanArguments& arguments) {
    const CommonOptions& common = arguments.common;
    PlanRequest& request = arguments.request;
    if (!arguments.band.empty()) request.plan.asked.band = parseSweep(arguments.band);
    request.runs.columns = common.column_map;
    request.runs.geometry = common.geometry;
    request.model_file = arguments.output;
    OutputFiles outputs;
    TerminalWatcher watcher(arguments.output, common, outputs);
    const PlanAnswer answer = runPlan(request, watcher);
    watcher.close();
    if (!arguments.output.empty()) addFittedModel(answer.fitted, arguments.output, outputs);
    if (common.printsText()) std::cout << formatText(answer, outputStyle());
    if (!common.json_file.empty()) writeJson(toJson(answer), common, outputs);
    if (!common.report_file.empty()) writeReport(answer, common.report_file, outputs);
    finishOutput(outputs);
}

void addLimit(CLI::App& command, const std::string& name, std::optional<double>& limit, const std::string& help) {
    command.add_option(name, limit, help + " (absent: as recorded)")->check(isPositive())->group("Limits");
}

}  // namespace

void addPlanCommand(CLI::App& app, int& /*exit_status*/) {
    auto* command =
        app.add_subcommand("plan", "The next test: which run would tell what these recordings leave open, by how much");
    const auto options = std::make_shared<PlanArguments>();
    AskedSetup& asked = options->request.plan.asked;
    addInputFile(*command, "recordings", options->request.runs.recordings,
                 std::string("recordings of one device (") + kReadableFormats + ")");
    addInputFile(*command, "--test", options->request.runs.test, "TOML that lists the runs of a test");
    addInputFile(*command, "--model", options->request.runs.model,
                 "mount model to start from (TOML); required unless the test file names one");
    addOutputFile(*command, "-o,--output", options->output,
                  "write the fitted model to FILE (TOML); the proposed commands then name it");
    command->add_option("--sweep", options->band, "f0:f1 in Hz, band of the further run (absent: as recorded)");
    command
        ->add_option("--rate", asked.octaves_per_minute,
                     "octaves per minute of the further run (absent: as recorded, and half of it)")
        ->check(isPositive());
    addLimit(*command, "--max-force", asked.force, "N, amplitude of the force");
    addLimit(*command, "--max-acceleration", asked.acceleration, "m/s^2, amplitude of the base's acceleration");
    addLimit(*command, "--max-displacement", asked.displacement, "m, amplitude of the base's displacement");
    addLimit(*command, "--max-stroke", asked.stroke, "m, relative displacement of a connection along any axis");
    command->add_option("--proposals", options->request.plan.most_proposals, "how many runs to list (default 5)")
        ->check(isPositive());
    command->add_option(
        "--free", options->request.plan.fit.free_body,
        "also identify body.center_of_gravity, body.inertia, or one component such as body.inertia.Ixx");
    command
        ->add_option("--use", options->request.use,
                     "channels of both parts to use: all, displacements or accelerations alone")
        ->check(CLI::IsMember({"all", "displacements", "accelerations"}));
    addCommonOptions(*command, options->common);
    addGeometryOption(*command, options->common);
    addMemoryOption(*command, options->request.memory);
    command->footer(
        "Each run of a list (force or base acceleration along x, y, z and between them) is simulated with the fitted\n"
        "model, measured with the recordings' noise, and fitted together with them.\n"
        "Example, what to do after one axial sweep with a shaker of 400 N:\n"
        "  identify plan axial.csv --model believed.toml --max-force 400 --report plan.html");
    command->callback([options] { answerPlan(*options); });
}

}  // namespace wems::identify::cli
