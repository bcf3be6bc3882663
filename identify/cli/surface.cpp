// identify surface: the restoring force surface of a single connection.
#include "identify/component/surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>

#include "identify/cli/command.hpp"
#include "identify/commands/component_fit.hpp"
#include "identify/commands/restoring_forces.hpp"
#include "identify/component/friction_model.hpp"
#include "identify/fit/law_verdict.hpp"
#include "models/command_line/usage.hpp"
#include "models/common/error.hpp"
#include "models/common/progress.hpp"
#include "models/recording/column_map.hpp"
#include "models/recording/recording_reader.hpp"

namespace wems::identify::cli {
namespace {

constexpr int kCells = 40;

struct SurfaceOptions {
    CommonOptions common;
    std::string recording;
    std::vector<std::string> validation;
    std::string connection, axis;
    std::vector<std::string> fail_on;
    double mass = 0, from = 0, to = 0, low_force = 0;
};

nlohmann::json formatSlice(const SurfaceSlice& slice, const char* at, const char* slab) {
    return {{at, slice.at}, {"force", slice.force}, {"count", slice.count}, {slab, slice.half_width}};
}

nlohmann::json formatGrid(const SurfaceGrid& grid) {
    auto median = nlohmann::json::array(), count = nlohmann::json::array();
    for (Eigen::Index i = 0; i < grid.median.rows(); ++i) {
        auto median_row = nlohmann::json::array(), count_row = nlohmann::json::array();
        for (Eigen::Index j = 0; j < grid.median.cols(); ++j) {
            const double f = grid.median(i, j);
            median_row.push_back(std::isfinite(f) ? nlohmann::json(f) : nlohmann::json());
            count_row.push_back(grid.count(i, j));
        }
        median.push_back(median_row);
        count.push_back(count_row);
    }
    return {{"displacement_edges", std::vector<double>(grid.q_edges.begin(), grid.q_edges.end())},
            {"velocity_edges", std::vector<double>(grid.v_edges.begin(), grid.v_edges.end())},
            {"median_force", median},
            {"count", count},
            {"residual_fraction", grid.fraction}};
}

/// What the best law of the kind that is named leaves of the force. A kind that is a law of displacement and velocity
/// does not take credit for what memory explains.
double calcLeft(const SurfaceKind& kind, const LawSelection& laws) {
    static const std::array<std::string, 6> of_state{"linear",    "hardening", "softening",
                                                     "clearance", "viscous",   "piecewise linear"};
    const bool remembers = std::none_of(of_state.begin(), of_state.end(),
                                        [&](const std::string& name) { return kind.name.rfind(name, 0) == 0; });
    double best = remembers ? laws.law().fraction : std::numeric_limits<double>::infinity();
    for (const auto& candidate : kind.candidates) best = std::min(best, candidate.fraction);
    return best;
}

nlohmann::json formatResult(const ComponentData& data, const SurfaceKind& kind, const LawSelection& laws,
                            const std::vector<ComponentData>& others) {
    auto candidates = nlohmann::json::array();
    for (const auto& c : kind.candidates)
        candidates.push_back({{"law", c.name},
                              {"residual_fraction", c.fraction},
                              {"criterion", c.information},
                              {"parameters", c.parameters}});
    const bool recorded = data.source == ForceSource::recorded;
    const double left = calcLeft(kind, laws);
    return {{"connection", data.connection},
            {"axis", std::string(1, "xyz"[data.axis])},
            {"units", {{"displacement", "m"}, {"velocity", "m/s"}, {"force", "N"}, {"time", "s"}}},
            {"force", {{"source", recorded ? "recorded" : "mass times acceleration"}, {"mass", data.mass}}},
            {"qualitative", data.qualitative},
            {"samples", data.count()},
            {"window", {data.time[0], data.time[data.count() - 1]}},
            {"kind", kind.name},
            {"statement", kind.statement},
            {"parameters", formatParameters(kind.parameters, kind.gains)},
            {"residual", {{"fraction", left}}},
            {"law_with_memory", toJson(laws, others, kind.gains)},
            {"verdict", formatLawVerdict(judgeLaw(left, std::numeric_limits<double>::infinity()))},
            {"candidates", candidates},
            {"effective_samples", kind.effective_samples},
            {"history_residual_fraction",
             std::isfinite(kind.history_fraction) ? nlohmann::json(kind.history_fraction) : nlohmann::json()},
            {"low_force", kind.strokes.low_force},
            {"gaps", kind.strokes.gap.strokes},
            {"surface", formatGrid(makeSurfaceGrid(data, kCells, kCells))},
            {"stiffness_curve", formatSlice(sliceStiffness(data, kCells), "displacement", "velocity_below")},
            {"damping_curve", formatSlice(sliceDamping(data, kCells), "velocity", "displacement_below")},
            {"notes", data.notes}};
}

void printResult(const ComponentData& data, const SurfaceKind& kind, const LawSelection& laws,
                 const std::vector<ComponentData>& others) {
    std::cout << "connection " << data.connection << ", axis "
              << "xyz"[data.axis] << ": " << data.count() << " samples, " << formatNumber(data.time[0], 6) << " to "
              << formatNumber(data.time[data.count() - 1], 6) << " s, displacement "
              << formatNumber(1e3 * data.q.minCoeff(), 4) << " to " << formatNumber(1e3 * data.q.maxCoeff(), 4)
              << " mm\n";
    std::cout << "kind: " << kind.name << (data.qualitative ? " (qualitative)" : "") << ". " << kind.statement
              << "\n\n";
    std::cout << tabulateParameters(kind.parameters).format(outputStyle()) << describeGains(kind.parameters, kind.gains)
              << "\n";
    Table tried({"law tried", "residual", "criterion"});
    for (const auto& c : kind.candidates)
        tried.addRow({c.name, formatNumber(100 * c.fraction, 3) + " %", formatNumber(c.information, 5)});
    if (std::isfinite(kind.history_fraction))
        tried.addRow({"travel since the reversal", formatNumber(100 * kind.history_fraction, 3) + " %", "-"});
    std::cout << tried.format(outputStyle());
    // A law with memory is shown where it says more than the laws of displacement and velocity.
    if (laws.law().terms.memory != LawTerms::Memory::none || laws.law().terms.relaxation || !others.empty())
        std::cout << formatText(laws, others, outputStyle());
    std::cout << describeLawVerdict(judgeLaw(calcLeft(kind, laws), std::numeric_limits<double>::infinity())) << "\n";
    for (const auto& note : data.notes) std::cout << "note: " << note << "\n";
    if (data.qualitative)
        std::cout << "note: other connections act on the same body, so that mass times acceleration is not this "
                     "connection's force alone: the shape counts, not the numbers\n";
}

/// A friction element simulated along the recorded motion, without and with a gap: fitted on `data`, and its error on
/// that and on other tests.
nlohmann::json reportFriction(const ComponentData& data, const std::vector<ComponentData>& others, bool print) {
    auto result = nlohmann::json::array();
    Table errors({"relative error", "without gap", "with gap"});
    std::vector<FrictionGapFit> fits;
    for (const bool with_gap : {false, true}) {
        fits.push_back(fitFrictionGap({data}, with_gap));
        auto validation = nlohmann::json::array();
        for (const auto& other : others)
            validation.push_back({{"file", other.file}, {"error", calcRelativeError(fits.back().law, other)}});
        result.push_back({{"gap", with_gap},
                          {"parameters", formatParameters(fits.back().parameters, gainTolerancesOf(data.source))},
                          {"error", fits.back().relative_error},
                          {"validation", validation}});
    }
    if (!print) return result;
    std::cout << "\nfriction element along the recorded motion, with presliding and gap:\n"
              << tabulateParameters(fits[1].parameters).format(outputStyle()) << "\n";
    errors.addRow(
        {data.file + " (fitted)", formatNumber(fits[0].relative_error, 3), formatNumber(fits[1].relative_error, 3)});
    for (const auto& other : others)
        errors.addRow({other.file, formatNumber(calcRelativeError(fits[0].law, other), 3),
                       formatNumber(calcRelativeError(fits[1].law, other), 3)});
    std::cout << errors.format(outputStyle());
    return result;
}

ResultRecord makeResultRecord(const SurfaceOptions& options, const ComponentOptions& component, const ColumnMap* map) {
    ResultRecord record = beginRecord("surface");
    record.addInput("columns", options.common.column_map);
    record.addInput("recording", options.recording);
    for (const std::string& file : options.validation) record.addInput("validation", file);
    record.options = {{"connection", options.connection}, {"axis", options.axis}, {"low_force", options.low_force}};
    if (component.mass) record.options["mass"] = *component.mass;
    if (component.from) record.options["from"] = *component.from;
    if (component.to) record.options["to"] = *component.to;
    if (map != nullptr) record.addColumns(*map);
    return record;
}

void runSurface(const SurfaceOptions& options, const CLI::App& command, int& exit_status) {
    OutputFiles outputs;
    ComponentOptions component;
    if (command.count("--from") > 0) component.from = options.from;
    if (command.count("--to") > 0) component.to = options.to;
    if (component.from && component.to && *component.from >= *component.to)
        throw InputError({"", 0, "--from/--to"}, "the window ends before it begins", "--from below --to, s");
    std::optional<ColumnMap> map;
    if (!options.common.column_map.empty()) map = readColumnMap(options.common.column_map);
    std::optional<Progress> progress(std::in_place, !options.common.quiet);
    progress->step({"reading " + options.recording});
    const Recording recording = readRecording(options.recording, map ? &*map : nullptr);
    component.connection = options.connection;
    if (!options.axis.empty()) component.axis = static_cast<int>(std::string("xyz").find(options.axis));
    if (command.count("--mass") > 0) component.mass = options.mass;
    component.time_known = !map || map->has_time || map->sample_interval != 1;
    component.unit_mass_allowed = !isComponentTest(recording);
    progress->step({"surface and laws", 0.1});
    const ComponentData data = extractComponent(recording, component);
    std::vector<ComponentData> others;
    for (const auto& file : options.validation)
        others.push_back(extractComponent(readRecording(file, map ? &*map : nullptr), component));
    progress->step({"laws with memory", 0.4});
    const LawSelection laws = selectLaw({data}, {});
    const SurfaceKind kind = nameByMemory(characteriseSurface(data, options.low_force), laws);
    progress.reset();
    const bool print = options.common.printsText();
    if (print) {
        for (const auto& warning : recording.warnings) std::cout << "warning: " << warning << "\n";
        printResult(data, kind, laws, others);
    }
    nlohmann::json result = formatResult(data, kind, laws, others);
    if (kind.name.find("friction") == 0) result["friction_element"] = reportFriction(data, others, print);
    if (!options.common.json_file.empty())
        addRecord(result, makeResultRecord(options, component, map ? &*map : nullptr));
    writeJson(result, options.common, outputs);
    if (!options.common.report_file.empty()) writeSurfaceReport(data, kind, options.common.report_file, outputs);
    finishOutput(outputs);
    failOn(options.fail_on, result.at("verdict"), exit_status);
}

}  // namespace

void addSurfaceCommand(CLI::App& app, int& exit_status) {
    auto* command = app.add_subcommand("surface", "Restoring force surface of a single connection");
    auto options = std::make_shared<SurfaceOptions>();
    addInputFile(*command, "recording", options->recording,
                 std::string("recording of the test (") + kReadableFormats + ")")
        ->required();
    command->add_option("--connection", options->connection, "connection; absent: the first one recorded");
    command->add_option("--axis", options->axis, "x, y or z; absent: the first one recorded")
        ->check(CLI::IsMember({"x", "y", "z"}));
    command->add_option("--mass", options->mass, "kg; the force is then mass x acceleration of the mobile end")
        ->check(isPositive());
    command->add_option("--from", options->from, "s, start of the window");
    command->add_option("--to", options->to, "s, end of the window");
    command
        ->add_option("--low-force", options->low_force,
                     "N, below which a force counts as gap; absent: 5 % of the friction level")
        ->check(isPositive());
    addInputFile(*command, "--validate", options->validation,
                 "other tests of the same element, on which a friction element is tried that was fitted here");
    addFailOption(*command, options->fail_on, {"identified", "doubtful", "unexplained"});
    addCommonOptions(*command, options->common);
    command->footer(
        "Examples, force measured, and force from the acceleration of a known mass:\n"
        "  identify surface machine.csv --columns map.toml --report element.html\n"
        "  identify surface drop.csv --columns map.toml --mass 0.639 --from 0.40 --to 0.55");
    command->callback([options, command, &exit_status] { runSurface(*options, *command, exit_status); });
}

}  // namespace wems::identify::cli
