// identify fit: stiffness, clearance, stop stiffness and damping of each connection and axis, with intervals.
#include "identify/fit/fit.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>

#include "identify/cli/campaign.hpp"
#include "identify/cli/command.hpp"
#include "identify/cli/component_fit.hpp"
#include "identify/cli/fit_output.hpp"
#include "identify/cli/fit_report.hpp"
#include "identify/cli/fitted_model.hpp"
#include "identify/cli/long_recordings.hpp"
#include "identify/cli/recordings.hpp"
#include "identify/fit/stopwatch.hpp"
#include "identify/motion/parallel.hpp"
#include "models/admissible_model.hpp"
#include "models/command_line/usage.hpp"
#include "models/error.hpp"
#include "models/format_number.hpp"
#include "models/progress.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::cli {
namespace {

constexpr double kReadingShare = 0.09, kMotionShare = 0.23;  // of the time when these steps are done, as measured

struct FitCommandOptions {
    CommonOptions common;
    FitOptions fit;
    MemoryOption memory;
    RunSelection runs;
    std::optional<TestCampaign> campaign;
    std::string output, use = "all";
    ComponentOptions component;
    std::string axis;
    double mass = 0, from = 0, to = 0;
    bool timing = false;
};

DeviceRuns estimateRuns(const FitCommandOptions& options, const MountModel& model, std::vector<Recording>& recordings,
                        Progress& progress) {
    DeviceRuns result;
    for (Recording& recording : recordings) keepOnly(options.use, recording);
    result.runs.resize(recordings.size());
    progress.step("motion of both parts", kReadingShare, kMotionShare);
    runParallel(recordings.size(), [&](std::size_t r) { result.runs[r] = estimateMotion(recordings[r], model); });
    for (std::size_t r = 0; r < recordings.size(); ++r) {
        for (const auto& warning : recordings[r].warnings) result.notes.push_back(recordings[r].file + ": " + warning);
        for (const auto& note : result.runs[r].notes) result.notes.push_back(recordings[r].file + ": " + note);
    }
    return result;
}

/// A mount that feeds its motion is none: the recording runs backwards, or a sign is wrong.
void noteNegativeDamping(const FitResult& fit, std::vector<std::string>& notes) {
    const std::string ending = ".damping";
    long known = 0, negative = 0;
    std::string first;
    for (const FittedParameter& parameter : fit.parameters) {
        const std::string& name = parameter.name;
        if (name.size() < ending.size() || name.compare(name.size() - ending.size(), ending.size(), ending) != 0)
            continue;
        ++known;
        if (!(parameter.interval95[1] < 0)) continue;
        ++negative;
        if (first.empty()) first = name + " = " + formatNumber(parameter.value, 3) + " " + parameter.unit;
    }
    if (2 * negative > known)
        notes.push_back("the mount feeds the motion with energy (" + first +
                        " and others): does the time run backwards, or has a channel the wrong sign?");
}

/// @param recordings of the runs; none where the runs are blocks of long ones
void fitDevice(const FitCommandOptions& options, const MountModel& model, const std::vector<Recording>& recordings,
               DeviceRuns device, Timing timing, std::unique_ptr<Progress> progress, OutputFiles& outputs) {
    Stopwatch watch(timing);
    const std::vector<RunMotion>& runs = device.runs;
    std::vector<std::string>& notes = device.notes;
    progress->step("equations of motion, parameters and intervals", device.blocks ? 0 : kMotionShare);
    const FitResult fit = fitMount(runs, model, options.fit);
    notes.insert(notes.end(), fit.notes.begin(), fit.notes.end());
    noteNegativeDamping(fit, notes);
    MountModel fitted = fit.model;
    if (!options.output.empty() || !options.runs.validation.empty())
        for (std::string& note : makeAdmissible(model, fitted)) notes.push_back(std::move(note));
    if (!options.output.empty()) addFittedModel(model, fitted, options.output, notes, outputs);
    watch.restart();  // the fit has steps of its own
    timing.insert(timing.end(), fit.timing.begin(), fit.timing.end());
    if (!options.runs.validation.empty()) progress->step("free simulations of the validation runs");
    const auto validation =
        validateModel(fitted, readDeviceRecordings(options.runs.validation, options.common.column_map, fitted));
    watch.lap("validation");
    if (!options.common.report_file.empty()) {
        progress->step("report");
        writeFitReport({fit, model, runs, recordings, notes, readDrawing(options.runs.model)},
                       options.common.report_file, outputs);
    }
    progress.reset();
    if (options.common.printsText()) {
        std::cout << makeParameterTable(fit).format(outputStyle());
        const Table open = makeOpenTable(fit);
        if (!open.rows().empty()) std::cout << "\n" << open.format(outputStyle());
        std::cout << "\n" << describeResidual(fit) << "\n";
        for (const ValidationError& run : validation)
            std::cout << "validation: " << options.campaign->describe(run.file) << ": "
                      << (run.problem.empty()
                              ? "error " + formatNumber(100 * run.error, 3) + " % of the measured relative displacement"
                              : run.problem)
                      << "\n";
        for (const auto& note : notes) std::cout << "note: " << note << "\n";
        if (options.timing)
            for (const auto& [step, seconds] : timing)
                std::cout << "time: " << step << " " << formatNumber(seconds, 3) << " s\n";
    }
    nlohmann::json result = makeFitJson(fit, notes, options.timing ? timing : Timing{});
    if (device.blocks) result["blocks"] = device.blocks->makeJson();
    for (const ValidationError& run : validation)
        result["validation"].push_back({{"run", run.file}, {"error", numberOrNull(run.error)}});
    writeJson(result, options.common, outputs);
}

/// Force over displacement, as measured and as the fitted law has it along the measured motion.
Plot plotElement(const ComponentData& data, const ComponentFit& fit) {
    const Eigen::VectorXd q = 1e3 * data.q;
    const Connection* connection = fit.fitted.connections.data();
    for (const Connection& candidate : fit.fitted.connections)
        if (candidate.name == fit.connection) connection = &candidate;
    const AxisForce law(connection->axis.at(static_cast<std::size_t>(fit.axis)));
    Plot plot{"Force over displacement: " + data.file, "displacement [mm]", "force [N]", {}, true};
    plot.series.push_back({"measured", {q.begin(), q.end()}, {data.force.begin(), data.force.end()}});
    if (law.law().friction && !data.has_velocity) return plot;  // its direction is not in the data
    Series fitted{"fitted", {q.begin(), q.end()}, {}};
    for (Eigen::Index k = 0; k < data.count(); ++k)
        fitted.y.push_back(law.calcForce(data.q[k], data.velocity[k], data.time[k], nullptr) + fit.force_offset);
    plot.series.push_back(std::move(fitted));
    return plot;
}

void fitElement(const FitCommandOptions& options, const MountModel& model, const std::vector<Recording>& recordings,
                OutputFiles& outputs) {
    ComponentFit fit = fitComponent(recordings, model, options.component);
    for (const Recording& recording : recordings)
        for (const auto& warning : recording.warnings) fit.notes.push_back(recording.file + ": " + warning);
    if (!options.output.empty()) addFittedModel(model, fit.fitted, options.output, fit.notes, outputs);
    reportComponentFit(fit, options.common, outputs);
    if (options.common.report_file.empty()) return;
    HtmlReport page("Identified element: connection " + fit.connection + ", axis " + "xyz"[fit.axis]);
    if (!fit.parameters.empty()) {
        const ComponentParameter& first = fit.parameters.front();
        const double radius = 0.5 * (first.upper - first.lower);
        page.addLead(first.name + " is " + formatNumber(first.value, 4) +
                     (std::isfinite(radius) && radius > 0 ? " +- " + formatNumber(radius, 2) : "") + " " + first.unit +
                     ".");
    }
    const Table table = tabulateParameters(fit.parameters);
    page.addTable(table.header(), table.rows());
    for (const Recording& recording : recordings) {
        const ComponentData data = extractComponent(recording, completeOptions(recording, model, options.component));
        page.addPlot(plotElement(data, fit));
    }
    for (const auto& note : fit.notes) page.addText(note);
    page.write(options.common.report_file, outputs);
}

bool asksForElement(const CLI::App& command) {
    return command.count("--mass") > 0 || command.count("--axis") > 0;
}

void runFit(FitCommandOptions options, const CLI::App& command, OutputFiles& outputs) {
    Timing timing;
    Stopwatch watch(timing);
    options.campaign = resolveRuns(options.runs, options.common);
    const MountModel model = readDeviceModel(options.runs.model, options.common.geometry);
    protectInputs(listInputs(options.runs, options.common, model), options.output, options.common, outputs);
    const std::optional<ColumnMap> map = readDeviceMap(options.common.column_map, model);
    auto progress = std::make_unique<Progress>(!options.common.quiet);
    const auto size = estimateSize(options.runs.recordings, map ? &*map : nullptr);
    if (size && !size->component && !asksForElement(command) &&
        exceedsMemory(*size, model, options.fit, options.memory)) {
        DeviceRuns device = chooseBlocks(options.runs.recordings, map ? &*map : nullptr, model, options.fit,
                                         options.use, *size, options.memory, *progress);
        watch.lap("reading and choice of blocks");
        fitDevice(options, model, {}, std::move(device), std::move(timing), std::move(progress), outputs);
        return;
    }
    std::vector<Recording> recordings;
    for (const auto& file : options.runs.recordings) {
        const auto files = static_cast<double>(options.runs.recordings.size());
        const auto read = static_cast<double>(recordings.size());
        progress->step("reading " + file, kReadingShare * read / files, kReadingShare * (read + 1) / files);
        recordings.push_back(readRecording(file, map ? &*map : nullptr));
        if (isComponentTest(recordings.back()) != isComponentTest(recordings.front()))
            throw InputError({file, 0, ""}, "a component test and a recording of a whole device",
                             "recordings of one kind in one fit");
    }
    watch.lap("reading");
    if (!isComponentTest(recordings.front()) && !asksForElement(command)) {
        checkFitStart(model, options.runs.model);
        checkSampleRate(recordings, model);
        checkDisplacements(recordings, model);
        for (Recording& recording : recordings) checkWhole(recording, model);
        watch.lap("checks");
        DeviceRuns device = estimateRuns(options, model, recordings, *progress);
        watch.lap("kinematics");
        fitDevice(options, model, recordings, std::move(device), std::move(timing), std::move(progress), outputs);
        return;
    }
    progress.reset();
    ComponentOptions& component = options.component;
    if (!options.axis.empty()) component.axis = static_cast<int>(std::string("xyz").find(options.axis));
    if (command.count("--mass") > 0) component.mass = options.mass;
    if (command.count("--from") > 0) component.from = options.from;
    if (command.count("--to") > 0) component.to = options.to;
    component.time_known = !map || map->has_time || map->sample_interval != 1;
    fitElement(options, model, recordings, outputs);
}

}  // namespace

void addFitCommand(CLI::App& app, int& /*exit_status*/) {
    auto* command = app.add_subcommand("fit", "Stiffness, clearance, stops and damping, each with its 95 % interval");
    const auto options = std::make_shared<FitCommandOptions>();
    addInputFile(*command, "recordings", options->runs.recordings,
                 std::string("recordings of one device or element (") + kReadableFormats + ")");
    addInputFile(*command, "--test", options->runs.test,
                 "TOML that lists the runs of a test; those of role validate judge the fitted model");
    addInputFile(*command, "--model", options->runs.model,
                 "mount model to start from (TOML); required unless the test file names one");
    addOutputFile(*command, "-o,--output", options->output,
                  "write the model with the identified values to FILE (TOML)");
    command->add_option(
        "--free", options->fit.free_body,
        "also identify body.center_of_gravity, body.inertia, or one component such as body.inertia.Ixx");
    command
        ->add_option("--use", options->use, "channels of both parts to use: all, displacements or accelerations alone")
        ->check(CLI::IsMember({"all", "displacements", "accelerations"}));
    command->add_flag("--timing", options->timing, "show how long each step took");
    addCommonOptions(*command, options->common);
    addGeometryOption(*command, options->common);
    addMemoryOption(*command, options->memory);
    const std::string element = "Component test (one element, force measured or a known mass)";
    command->add_option("--connection", options->component.connection, "absent: the first one recorded")
        ->group(element);
    command->add_option("--axis", options->axis, "x, y or z; absent: the first one recorded")
        ->check(CLI::IsMember({"x", "y", "z"}))
        ->group(element);
    command->add_option("--mass", options->mass, "kg; the force is then mass x acceleration of the mobile end")
        ->check(isPositive())
        ->group(element);
    command->add_option("--from", options->from, "s, start of the window")->group(element);
    command->add_option("--to", options->to, "s, end of the window")->group(element);
    command->footer(
        "Examples:\n"
        "  identify fit axial.csv oblique.csv --model believed.toml -o fitted.toml --json fit.json\n"
        "  identify fit --test campaign.toml -o fitted.toml\n"
        "  identify fit drop.csv --columns map.toml --model element.toml --mass 0.639 --from 0.40 --to 0.55");
    command->callback([options, command] {
        OutputFiles outputs;
        runFit(*options, *command, outputs);
        finishOutput(outputs);
    });
}

}  // namespace wems::identify::cli
