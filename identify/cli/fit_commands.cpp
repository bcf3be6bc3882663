// identify fit: stiffness, clearance, stop stiffness and damping of each connection and axis, with intervals.
#include <iostream>
#include <memory>
#include <optional>

#include "identify/cli/command.hpp"
#include "identify/commands/fit.hpp"
#include "identify/commands/fit_output.hpp"
#include "identify/commands/recordings.hpp"
#include "identify/fit/stored_equations.hpp"
#include "models/command_line/usage.hpp"
#include "models/common/progress.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/report/html_report.hpp"

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
        watcher.onStep({"report"});
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
        "also identify body.center_of_gravity, body.inertia, or one component such as body.inertia.Ixx; by simulation "
        "any number of the model, such as 1.z.cubic or body.mass");
    command
        ->add_option("--method", options->request.method,
                     "fit to the equations of motion, or to free simulations, which need no derivatives; auto takes "
                     "motion wherever the sampling holds them, or the device itself gives what lies between samples "
                     "of a contact")
        ->check(CLI::IsMember({"auto", "motion", "simulation"}));
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

// identify equations and identify join: one fit of many recordings, each worked on by a process of its own.

namespace {

constexpr const char* kFreeHelp =
    "also identify body.center_of_gravity, body.inertia, or one component such as body.inertia.Ixx";

struct EquationsOptions {
    CommonOptions common;
    FitOptions fit;
    std::string recording, model, output, use = "all";
};

void runEquations(const EquationsOptions& options) {
    OutputFiles outputs;
    const MountModel model = readDeviceModel(options.model, options.common.geometry);
    protectInputs({model.bracket_path}, options.output, options.common, outputs);
    const std::optional<ColumnMap> map = readDeviceMap(options.common.column_map, model);
    std::optional<Progress> progress(std::in_place, !options.common.quiet);
    progress->step({"reading " + options.recording});
    std::vector<Recording> recordings{readRecording(options.recording, map ? &*map : nullptr)};
    checkFitStart(model, options.model);
    checkSampleRate(recordings, model);
    checkDisplacements(recordings, model);
    Recording& recording = recordings.front();
    checkWhole(recording, model);
    keepOnly(options.use, recording);
    progress->step({"motion of both parts", 0.3});
    RunMotion motion = estimateMotion(recording, model);
    motion.notes.insert(motion.notes.begin(), recording.warnings.begin(), recording.warnings.end());
    progress->step({"equations of motion", 0.6});
    const StoredRun run = makeStoredRun(std::move(motion), model, options.fit);
    writeStoredRun(run, model, options.fit, options.output, outputs);
    progress.reset();
    const int equations = 6 * run.equations.outputs;
    if (!options.common.json_file.empty()) {
        ResultRecord record = beginRecord("equations");
        record.addInput("recording", options.recording);
        record.addInput("model", options.model);
        record.addInput("columns", options.common.column_map);
        if (map) record.addColumns(*map);
        record.options = {{"free", options.fit.free_body}, {"use", options.use}};
        nlohmann::json result{{"file", options.output},
                              {"equations", equations},
                              {"unknowns", run.equations.columns.cols()},
                              {"notes", run.motion.notes}};
        addRecord(result, record);
        writeJson(result, options.common, outputs);
    }
    if (!options.common.report_file.empty()) {
        HtmlReport page("Equations of motion: " + options.recording);
        page.addList(run.motion.notes);
        page.write(options.common.report_file, outputs);
    }
    if (options.common.printsText())
        std::cout << options.output << ": " << equations << " equations with " << run.equations.columns.cols()
                  << " columns\n";
    finishOutput(outputs);
}

struct JoinOptions {
    CommonOptions common;
    FitOptions fit;
    std::vector<std::string> files;
    std::string model, output;
};

void runJoin(const JoinOptions& options) {
    OutputFiles outputs;
    const MountModel model = readDeviceModel(options.model, options.common.geometry);
    protectInputs({model.bracket_path}, options.output, options.common, outputs);
    checkFitStart(model, options.model);
    std::optional<Progress> progress(std::in_place, !options.common.quiet);
    std::vector<RunMotion> runs;
    std::vector<RunEquations> equations;
    std::vector<std::string> notes;
    progress->step({"reading equations"});
    for (const std::string& file : options.files) {
        StoredRun run = readStoredRun(file, model, options.fit);
        for (const std::string& note : run.motion.notes) notes.push_back(run.motion.file + ": " + note);
        runs.push_back(std::move(run.motion));
        equations.push_back(std::move(run.equations));
    }
    progress->step({"parameters and intervals", 0.3});
    const FitResult fit = solveEquations(runs, std::move(equations), model, options.fit);
    notes.insert(notes.end(), fit.notes.begin(), fit.notes.end());
    if (!options.output.empty()) {
        MountModel fitted = fit.model;
        for (std::string& note : makeAdmissible(model, fitted)) notes.push_back(std::move(note));
        addFittedModel(fitted, options.output, outputs);
    }
    progress.reset();
    const Table parameters = makeParameterTable(fit), open = makeOpenTable(fit);
    if (!options.common.report_file.empty()) {
        HtmlReport page("Identified mount: " + fit.model.name);
        page.addLead(describeResidual(fit));
        page.addTable(parameters.header(), parameters.rows());
        if (!open.rows().empty()) page.addTable(open.header(), open.rows());
        page.addList(notes);
        page.write(options.common.report_file, outputs);
    }
    if (options.common.printsText()) {
        std::cout << parameters.format(outputStyle());
        if (!open.rows().empty()) std::cout << "\n" << open.format(outputStyle());
        std::cout << "\n" << describeResidual(fit) << "\n";
        for (const auto& note : notes) std::cout << "note: " << note << "\n";
    }
    if (!options.common.json_file.empty()) {
        ResultRecord record = beginRecord("join");
        for (const std::string& file : options.files) record.addInput("equations", file);
        record.addInput("model", options.model);
        record.options = {{"free", options.fit.free_body}};
        nlohmann::json result = makeFitJson(fit, notes, {});
        addRecord(result, record);
        writeJson(result, options.common, outputs);
    }
    finishOutput(outputs);
}

}  // namespace

void addEquationsCommand(CLI::App& app, int& /*exit_status*/) {
    auto* command = app.add_subcommand("equations", "One run's equations for a fit of many, as a file for join");
    const auto options = std::make_shared<EquationsOptions>();
    addInputFile(*command, "recording", options->recording, std::string("recording (") + kReadableFormats + ")")
        ->required();
    addInputFile(*command, "--model", options->model, "mount model to start from (TOML)")->required();
    addOutputFile(*command, "-o,--output", options->output, "the run's equations")->required();
    command->add_option("--free", options->fit.free_body, kFreeHelp);
    command
        ->add_option("--use", options->use, "channels of both parts to use: all, displacements or accelerations alone")
        ->check(CLI::IsMember({"all", "displacements", "accelerations"}));
    addCommonOptions(*command, options->common);
    addGeometryOption(*command, options->common);
    command->footer(
        "Example, each of the first two on a machine of its own:\n"
        "  identify equations axial.csv --model believed.toml -o axial.equations\n"
        "  identify equations oblique.csv --model believed.toml -o oblique.equations\n"
        "  identify join axial.equations oblique.equations --model believed.toml -o fitted.toml");
    command->callback([options] { runEquations(*options); });
}

void addJoinCommand(CLI::App& app, int& /*exit_status*/) {
    auto* command = app.add_subcommand("join", "The fit of many runs from the equations of each");
    const auto options = std::make_shared<JoinOptions>();
    addInputFile(*command, "equations", options->files, "files that identify equations wrote with the same model")
        ->required();
    addInputFile(*command, "--model", options->model, "mount model to start from (TOML)")->required();
    addOutputFile(*command, "-o,--output", options->output,
                  "write the model with the identified values to FILE (TOML)");
    command->add_option("--free", options->fit.free_body, kFreeHelp);
    addResultOptions(*command, options->common);
    addGeometryOption(*command, options->common);
    command->footer(
        "Example:\n"
        "  identify join axial.equations oblique.equations --model believed.toml -o fitted.toml");
    command->callback([options] { runJoin(*options); });
}

}  // namespace wems::identify::cli
