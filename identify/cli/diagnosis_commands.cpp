// identify compare: errors of a simulated recording, channel by channel, by frequency band and by regime.
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include "identify/cli/command.hpp"
#include "identify/commands/compare.hpp"
#include "identify/commands/diagnose.hpp"
#include "identify/commands/fit_output.hpp"
#include "identify/commands/plan.hpp"
#include "models/command_line/usage.hpp"
#include "models/common/error.hpp"
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

// identify diagnose: what the simulation gets wrong, the named causes, the extended model, the gain.

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
        watcher.onStep({"report"});
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

// identify plan: the next test, which run would tell what the recordings leave open.

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
