// identify beam-tip: the spring at the tip of a beam from the complete and from the truncated equation of the tip.
#include "identify/paper/beam_tip.hpp"

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>

#include "identify/cli/command.hpp"
#include "models/command_line/usage.hpp"
#include "models/progress.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::cli {
namespace {

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
    progress->step("reading " + options.recording);
    const Recording recording = readRecording(options.recording, map ? &*map : nullptr);
    progress->step("regression", 0.6);
    const BeamTip tip = identifyBeamTip(recording, Beam{});
    progress.reset();
    Table table({"equation of the tip", "cubic [N/m^3]", "linear part", "damping", "unexplained"});
    for (const auto& [name, spring] : {std::pair("complete", &tip.complete), std::pair("truncated", &tip.truncated)})
        table.addRow({name, formatNumber(spring->cubic, 6), formatNumber(spring->stiffness, 6),
                      formatNumber(spring->damping, 4), formatNumber(100 * spring->residual_fraction, 3) + " %"});
    if (options.common.printsText()) std::cout << table.format(outputStyle());
    nlohmann::json data = {{"complete", makeJson(tip.complete, "-", "s")},
                           {"truncated", makeJson(tip.truncated, "N/m", "N s/m")}};
    ResultRecord record = beginRecord("beam-tip");
    record.addInput("columns", options.common.column_map);
    record.addInput("recording", options.recording);
    if (map) record.addColumns(*map);
    addRecord(data, record);
    writeJson(data, options.common, outputs);
    if (!options.common.report_file.empty())
        writeReport(tip, table, recording.file, options.common.report_file, outputs);
    finishOutput(outputs);
}

}  // namespace

void addBeamTipCommand(CLI::App& app, int& /*exit_status*/) {
    auto* command = app.add_subcommand(
        "beam-tip", "Cubic spring at the tip of the benchmark beam, from the complete and the truncated tip equation");
    const auto options = std::make_shared<BeamTipOptions>();
    addInputFile(*command, "recording", options->recording, "recording of simulate_beam (CSV)")->required();
    addCommonOptions(*command, options->common);
    command->footer("Example:\n  identify beam-tip beam.csv --json beam.json");
    command->callback([options] { runBeamTip(*options); });
}

}  // namespace wems::identify::cli
