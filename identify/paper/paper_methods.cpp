// The executable `paper_methods`: the regressions of the source paper, for comparison with those of `identify`.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>

#include "identify/cli/command.hpp"
#include "identify/commands/fit_output.hpp"
#include "identify/commands/recordings.hpp"
#include "identify/paper/beam_tip.hpp"
#include "identify/paper/single_axis.hpp"
#include "models/command_line/standard_streams.hpp"
#include "models/command_line/usage.hpp"
#include "models/common/error.hpp"
#include "models/common/progress.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::cli {

namespace {

ResultRecord beginPaperRecord(const std::string& command) {
    ResultRecord record = beginRecord(command);
    record.program = "wems paper_methods " WEMS_VERSION;
    return record;
}

struct BeamTipOptions {
    CommonOptions common;
    std::string recording;
};

nlohmann::json makeJson(const TipSpring& spring, const std::string& elastic, const std::string& viscous) {
    nlohmann::json w = nlohmann::json::array(), force = nlohmann::json::array();
    const Eigen::Index stride = std::max<Eigen::Index>(1, spring.deflection.size() / 3000);
    for (Eigen::Index k = 0; k < spring.deflection.size(); k += stride) {
        w.push_back(spring.deflection(k));
        force.push_back(spring.force(k));
    }
    return {{"parameters",
             {{{"name", "cubic"}, {"value", spring.cubic}, {"unit", "N/m^3"}},
              {{"name", "stiffness"}, {"value", spring.stiffness}, {"unit", elastic}},
              {{"name", "damping"}, {"value", spring.damping}, {"unit", viscous}}}},
            {"residual", {{"fraction", spring.residual_fraction}}},
            {"spring", {{"displacement", w}, {"force", force}}}};
}

/// @param linear stiffness that the force holds besides the cubic one, N/m
void addPlot(HtmlReport& page, const std::string& title, const TipSpring& spring, double linear) {
    const Eigen::VectorXd w = 1e3 * spring.deflection,
                          fitted = linear * spring.deflection.array() + spring.cubic * spring.deflection.array().cube();
    page.addPlot({title,
                  "tip deflection [mm]",
                  "force [N]",
                  {{"nonparametric", {w.begin(), w.end()}, {spring.force.begin(), spring.force.end()}},
                   {"fitted", {w.begin(), w.end()}, {fitted.begin(), fitted.end()}}},
                  true});
}

void writeReport(const BeamTip& tip, const Table& table, const std::string& recording, const std::string& file,
                 OutputFiles& outputs) {
    HtmlReport page("Spring at the tip of the beam: " + recording);
    page.addLead("The spring hardens with " + formatNumber(tip.complete.cubic, 4) + " N/m^3; the equation leaves " +
                 formatNumber(100 * tip.complete.residual_fraction, 3) + " % of the inertia force.");
    page.addTable(table.header(), table.rows());
    addPlot(page, "Complete equation of the tip", tip.complete, 0);
    addPlot(page, "Truncated equation of the tip", tip.truncated, tip.truncated.stiffness);
    page.write(file, outputs);
}

void runBeamTip(const BeamTipOptions& options) {
    OutputFiles outputs;
    const std::optional<ColumnMap> map =
        options.common.column_map.empty() ? std::nullopt : std::optional(readColumnMap(options.common.column_map));
    std::optional<Progress> progress(std::in_place, !options.common.quiet);
    progress->step({"reading " + options.recording});
    const Recording recording = readRecording(options.recording, map ? &*map : nullptr);
    progress->step({"regression", 0.6});
    const BeamTip tip = identifyBeamTip(recording, Beam{});
    progress.reset();
    Table table({"equation of the tip", "cubic [N/m^3]", "linear part", "damping", "unexplained"});
    for (const auto& [name, spring] : {std::pair("complete", &tip.complete), std::pair("truncated", &tip.truncated)})
        table.addRow({name, formatNumber(spring->cubic, 6), formatNumber(spring->stiffness, 6),
                      formatNumber(spring->damping, 4), formatNumber(100 * spring->residual_fraction, 3) + " %"});
    if (options.common.printsText()) std::cout << table.format(outputStyle());
    nlohmann::json data = {{"complete", makeJson(tip.complete, "-", "s")},
                           {"truncated", makeJson(tip.truncated, "N/m", "N s/m")}};
    ResultRecord record = beginPaperRecord("beam-tip");
    record.addInput("columns", options.common.column_map);
    record.addInput("recording", options.recording);
    if (map) record.addColumns(*map);
    addRecord(data, record);
    writeJson(data, options.common, outputs);
    if (!options.common.report_file.empty())
        writeReport(tip, table, recording.file, options.common.report_file, outputs);
    finishOutput(outputs);
}

void addBeamTipCommand(CLI::App& app) {
    auto* command = app.add_subcommand(
        "beam-tip", "Cubic spring at the tip of the benchmark beam, from the complete and the truncated tip equation");
    const auto options = std::make_shared<BeamTipOptions>();
    addInputFile(*command, "recording", options->recording, "recording of simulate_beam (CSV)")->required();
    addCommonOptions(*command, options->common);
    command->footer("Example:\n  paper_methods beam-tip beam.csv --json beam.json");
    command->callback([options] { runBeamTip(*options); });
}

// identify single-axis: the classical regression, Newton's equation of one axis with truncated SVD.

struct SingleAxisCommandOptions {
    CommonOptions common;
    SingleAxisOptions method;
    std::string recording, model, output, axis = "z", candidates, acceleration = "centre";
    std::vector<double> window;
    int samples = 2000;
};

nlohmann::json makeJson(const SingleAxisResult& result, int samples) {
    auto terms = nlohmann::json::array(), curves = nlohmann::json::array();
    for (const SingleAxisTerm& term : result.terms) {
        terms.push_back({{"name", term.name},
                         {"value", term.value},
                         {"unit", term.unit},
                         {"model_value", term.model_value},
                         {"held", term.held},
                         {"confidence_factor", numberOrNull(term.confidence)},
                         {"confidence_factor_refitted", numberOrNull(term.confidence_refitted)}});
        if (term.q.size() == 0) continue;
        nlohmann::json q = nlohmann::json::array(), force = nlohmann::json::array();
        const Eigen::Index stride = std::max<Eigen::Index>(1, term.q.size() / std::max(1, samples));
        for (Eigen::Index k = 0; k < term.q.size(); k += stride) {
            q.push_back(term.q(k));
            force.push_back(term.force(k));
        }
        curves.push_back({{"term", term.name}, {"displacement", q}, {"force", force}});
    }
    return {{"terms", terms},
            {"singular_values_percent",
             std::vector<double>(result.singular_percent.begin(), result.singular_percent.end())},
            {"rank", result.rank},
            {"residual", {{"fraction", result.residual_fraction}}},
            {"nonparametric", curves},
            {"notes", result.notes}};
}

Table makeTable(const SingleAxisResult& result) {
    Table table({"term", "model", "identified", "unit", "confidence factor", "others refitted"});
    for (const SingleAxisTerm& term : result.terms)
        table.addRow({term.name, formatNumber(term.model_value), term.held ? "held" : formatNumber(term.value, 6),
                      term.unit, term.held ? "-" : formatNumber(term.confidence, 4),
                      term.held ? "-" : formatNumber(term.confidence_refitted, 4)});
    return table;
}

std::string describeSingularValues(const SingleAxisResult& result) {
    std::string text = "singular values, percent of their sum:";
    for (const double value : result.singular_percent) text += " " + formatNumber(value, 3);
    return text + "; " + std::to_string(result.rank) + " kept";
}

std::string describeResidual(const SingleAxisResult& result) {
    return "unexplained: " + formatNumber(100 * result.residual_fraction, 3) + " % of the force";
}

void writeReport(const SingleAxisResult& result, const std::string& recording, const std::string& file,
                 OutputFiles& outputs) {
    HtmlReport page("One-axis regression: " + recording);
    page.addLead("One equation of motion leaves " + formatNumber(100 * result.residual_fraction, 3) +
                 " % of the force unexplained.");
    const Table table = makeTable(result);
    page.addTable(table.header(), table.rows());
    page.addText(describeSingularValues(result));
    page.addText(describeResidual(result));
    for (const SingleAxisTerm& term : result.terms) {
        if (term.q.size() == 0) continue;
        const Eigen::VectorXd q = 1e3 * term.q, fitted = term.value * term.q;
        page.addPlot({"Restoring force of " + term.name.substr(0, term.name.rfind('.')),
                      "relative displacement [mm]",
                      "force [N]",
                      {{"nonparametric", {q.begin(), q.end()}, {term.force.begin(), term.force.end()}},
                       {"elastomer", {q.begin(), q.end()}, {fitted.begin(), fitted.end()}}},
                      true});
    }
    for (const auto& note : result.notes) page.addText(note);
    page.write(file, outputs);
}

ResultRecord makeResultRecord(const SingleAxisCommandOptions& options, const MountModel& model) {
    ResultRecord record = beginPaperRecord("single-axis");
    record.addInput("model", options.model);
    record.addInput("bracket modes", model.bracket_path);
    record.addInput("columns", options.common.column_map);
    record.addInput("recording", options.recording);
    record.options = {{"axis", options.axis},
                      {"candidates", options.candidates},
                      {"acceleration", options.acceleration},
                      {"truncate", options.method.keep},
                      {"hold_elastomers", options.method.hold_elastomers},
                      {"stops", options.method.stops},
                      {"damping", options.method.damping},
                      {"window", options.window},
                      {"samples", options.samples}};
    if (const auto map = readOptionalMap(options.common.column_map)) record.addColumns(*map);
    return record;
}

void runSingleAxis(SingleAxisCommandOptions options) {
    OutputFiles outputs;
    const std::string axes = "xyz";
    SingleAxisOptions& method = options.method;
    method.axis = static_cast<int>(axes.find(options.axis));
    for (const char candidate : options.candidates) {
        const auto axis = axes.find(candidate);
        if (axis == std::string::npos ||
            std::count(options.candidates.begin(), options.candidates.end(), candidate) > 1)
            throw InputError({{}, 0, "--candidates"}, "is `" + options.candidates + "`",
                             "letters out of xyz, each once, such as xyz");
        method.candidates.push_back(static_cast<int>(axis));
    }
    if (options.acceleration == "cog") method.point = AccelerationPoint::center_of_gravity;
    if (!options.window.empty()) {
        method.lowest = options.window.front();
        method.highest = options.window.back();
        if (!(method.lowest < method.highest))
            throw InputError({{}, 0, "--window"}, "does not ascend", "lowest and highest swept frequency, Hz");
    }
    const MountModel model = readMountModel(options.model);
    protectInputs({model.bracket_path}, options.output, options.common, outputs);
    std::optional<Progress> progress(std::in_place, !options.common.quiet);
    progress->step({"reading " + options.recording});
    const Recording recording = readDeviceRecordings({options.recording}, options.common.column_map, model).front();
    progress->step({"regression", 0.6});
    SingleAxisResult result = identifySingleAxis(recording, model, method);
    progress.reset();
    result.notes.insert(result.notes.begin(), recording.warnings.begin(), recording.warnings.end());
    if (!options.output.empty()) {
        MountModel fitted = result.model;
        for (std::string& note : makeAdmissible(model, fitted)) result.notes.push_back(std::move(note));
        addFittedModel(fitted, options.output, outputs);
    }
    if (options.common.printsText()) {
        std::cout << makeTable(result).format(outputStyle()) << describeSingularValues(result) << "\n"
                  << describeResidual(result) << "\n";
        for (const auto& note : result.notes) std::cout << "note: " << note << "\n";
    }
    nlohmann::json data = makeJson(result, options.samples);
    addRecord(data, makeResultRecord(options, model));
    writeJson(data, options.common, outputs);
    if (!options.common.report_file.empty()) writeReport(result, recording.file, options.common.report_file, outputs);
    finishOutput(outputs);
}

void addSingleAxisCommand(CLI::App& app) {
    auto* command =
        app.add_subcommand("single-axis", "Classical one-axis regression with truncated SVD, to compare with `fit`");
    const auto options = std::make_shared<SingleAxisCommandOptions>();
    addInputFile(*command, "recording", options->recording,
                 std::string("recording of the device (") + kReadableFormats + ")")
        ->required();
    addInputFile(*command, "--model", options->model, "mount model: mass, clearances, values to hold (TOML)")
        ->required();
    command->add_option("--axis", options->axis, "axis of Newton's equation (default z)")
        ->check(CLI::IsMember({"x", "y", "z"}));
    command->add_option("--candidates", options->candidates,
                        "axes whose forces may enter, such as xyz (default: the axis of the equation)");
    command
        ->add_option("--acceleration", options->acceleration,
                     "of which point: centre (mean of the markers, default) or cog")
        ->check(CLI::IsMember({"centre", "cog"}));
    command
        ->add_option("--truncate", options->method.keep,
                     "singular values to keep (default: those before the first gap of a factor 20; 99 for all)")
        ->check(isPositive());
    command->add_flag("--hold-elastomers", options->method.hold_elastomers,
                      "keep the model's elastomer stiffnesses and identify the stops alone");
    command->add_flag_callback(
        "--no-stops", [options] { options->method.stops = false; }, "leave stops out even where they are reached");
    command->add_flag("--damping", options->method.damping, "add one dashpot for each candidate axis");
    command->add_option("--window", options->window, "lowest and highest swept frequency to use, Hz")->expected(2);
    command->add_option("--samples", options->samples, "samples of each nonparametric curve in the JSON (default 2000)")
        ->check(isPositive());
    addOutputFile(*command, "-o,--output", options->output, "write the model with the identified stiffnesses (TOML)");
    addCommonOptions(*command, options->common);
    command->footer(
        "Example, elastomers at a low level, then the stops at a high one:\n"
        "  paper_methods single-axis low.csv --model mount.toml --axis z -o linear.toml\n"
        "  paper_methods single-axis high.csv --model linear.toml --axis z --hold-elastomers --json stops.json");
    command->callback([options] { runSingleAxis(*options); });
}

int runPaperMethods(int argc, char** argv) {
    CLI::App app{"The regressions of the source paper: one axis alone, and the tip of a beam."};
    app.name(programName(argv[0]));
    app.require_subcommand(1);
    app.set_version_flag("--version", "wems paper_methods " WEMS_VERSION);
    addSingleAxisCommand(app);
    addBeamTipCommand(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // help or version
        throw InputError({}, describeUsageError(app, error));
    }
    return 0;
}

}  // namespace
}  // namespace wems::identify::cli

int main(int argc, char** argv) {
    return wems::runProgram("paper_methods", wems::identify::cli::runPaperMethods, argc, argv);
}
