// identify plan: the next test, which run would tell what the recordings leave open.
#include "identify/plan/plan.hpp"

#include <cstdio>
#include <iostream>
#include <memory>

#include "identify/cli/campaign.hpp"
#include "identify/cli/command.hpp"
#include "identify/cli/fitted_model.hpp"
#include "identify/cli/long_recordings.hpp"
#include "identify/cli/plan_output.hpp"
#include "identify/cli/recordings.hpp"
#include "identify/component/component_data.hpp"
#include "identify/motion/parallel.hpp"
#include "models/command_line/usage.hpp"
#include "models/error.hpp"
#include "models/progress.hpp"
#include "models/recording/recording_reader.hpp"

namespace wems::identify::cli {
namespace {

struct PlanCommandOptions {
    CommonOptions common;
    PlanOptions plan;
    MemoryOption memory;
    RunSelection runs;
    std::string output, use = "all", band;
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

std::vector<Recording> readRuns(const PlanCommandOptions& options, const MountModel& model) {
    const std::optional<ColumnMap> map = readDeviceMap(options.common.column_map, model);
    const auto size = estimateSize(options.runs.recordings, map ? &*map : nullptr);
    if (size && !size->component && exceedsMemory(*size, model, options.plan.fit, options.memory))
        throw InputError({options.runs.recordings.front(), 0, "time"},
                         "the recordings need more than the memory of --memory",
                         "more memory, or the part of the recordings that identify convert cuts out");
    std::vector<Recording> recordings = readDeviceRecordings(options.runs.recordings, options.common.column_map, model);
    for (const Recording& recording : recordings)
        if (isComponentTest(recording))
            throw InputError({recording.file, 0, ""}, "a component test, which has no direction to choose",
                             "recordings of a whole device");
    checkFitStart(model, options.runs.model);
    checkSampleRate(recordings, model);
    for (Recording& recording : recordings) keepOnly(options.use, recording);
    return recordings;
}

void runPlan(PlanCommandOptions options, OutputFiles& outputs) {
    if (!options.band.empty()) options.plan.asked.band = parseSweep(options.band);
    const auto campaign = resolveRuns(options.runs, options.common);
    const MountModel model = readDeviceModel(options.runs.model, options.common.geometry);
    const std::vector<std::string> inputs = listInputs(options.runs, options.common, model);
    protectInputs(inputs, options.output, options.common, outputs);
    auto progress = std::make_unique<Progress>(!options.common.quiet);
    progress->step("reading");
    const std::vector<Recording> recordings = readRuns(options, model);
    progress->step("motion of both parts");
    std::vector<RunMotion> runs(recordings.size());
    runParallel(runs.size(), [&](std::size_t r) { runs[r] = estimateMotion(recordings[r], model); });
    constexpr double before = 0.1;  // of the time, for what comes before the rehearsals
    options.plan.progress = [&](double done, const std::string& what) {
        progress->step(what, before + (1 - before) * done, 1);
    };
    Plan plan = makePlan(runs, recordings, model, options.plan);
    progress.reset();
    for (const Recording& recording : recordings)
        for (const auto& warning : recording.warnings) plan.notes.push_back(recording.file + ": " + warning);
    if (!options.output.empty()) addFittedModel(model, plan.now.model, options.output, plan.notes, outputs);
    const std::string& named = options.output.empty() ? options.runs.model : options.output;
    if (options.common.printsText()) std::cout << formatPlan(plan, named, outputStyle());
    std::vector<std::string> read;
    for (const auto& file : inputs)
        if (!file.empty()) read.push_back(file);
    writeJson(makePlanJson(plan, named, read), options.common, outputs);
    if (!options.common.report_file.empty()) writePlanReport(plan, named, options.common.report_file, outputs);
}

void addLimit(CLI::App& command, const std::string& name, std::optional<double>& limit, const std::string& help) {
    command.add_option(name, limit, help + " (absent: as recorded)")->check(isPositive())->group("Limits");
}

}  // namespace

void addPlanCommand(CLI::App& app, int& /*exit_status*/) {
    auto* command =
        app.add_subcommand("plan", "The next test: which run would tell what these recordings leave open, by how much");
    const auto options = std::make_shared<PlanCommandOptions>();
    AskedSetup& asked = options->plan.asked;
    addInputFile(*command, "recordings", options->runs.recordings,
                 std::string("recordings of one device (") + kReadableFormats + ")");
    addInputFile(*command, "--test", options->runs.test, "TOML that lists the runs of a test");
    addInputFile(*command, "--model", options->runs.model,
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
    command->add_option("--proposals", options->plan.most_proposals, "how many runs to list (default 5)")
        ->check(isPositive());
    command->add_option(
        "--free", options->plan.fit.free_body,
        "also identify body.center_of_gravity, body.inertia, or one component such as body.inertia.Ixx");
    command
        ->add_option("--use", options->use, "channels of both parts to use: all, displacements or accelerations alone")
        ->check(CLI::IsMember({"all", "displacements", "accelerations"}));
    addCommonOptions(*command, options->common);
    addGeometryOption(*command, options->common);
    addMemoryOption(*command, options->memory);
    command->footer(
        "Each run of a list (force or base acceleration along x, y, z and between them) is simulated with the fitted\n"
        "model, measured with the recordings' noise, and fitted together with them.\n"
        "Example, what to do after one axial sweep with a shaker of 400 N:\n"
        "  identify plan axial.csv --model believed.toml --max-force 400 --report plan.html");
    command->callback([options] {
        OutputFiles outputs;
        runPlan(*options, outputs);
        finishOutput(outputs);
    });
}

}  // namespace wems::identify::cli
