// The report of a linear analysis.
#include <cmath>

#include "models/format_number.hpp"
#include "models/pi.hpp"
#include "models/report/html_report.hpp"
#include "models/report/motion_scene.hpp"
#include "models/text_table.hpp"
#include "plugin/linear_analysis.hpp"

namespace wems::plugin {
namespace {

constexpr Eigen::Index kFrames = 48;  // of one period

/// So large that the stop that a mode reaches first is just touched; 1 mm without stops.
double findAmplitude(const LinearAnalysis& analysis, const DampedMode& mode) {
    double amplitude = 1e300;
    for (const StopMargin& stop : analysis.sag.stops) {
        const double share = std::abs((analysis.system.ends[stop.connection].row(stop.axis) * mode.shape).value());
        if (share > 1e-3 && stop.left > 0) amplitude = std::min(amplitude, stop.left / share);
    }
    return amplitude < 1e300 ? amplitude : 1e-3;
}

SceneRun makeModeRun(const LinearAnalysis& analysis, std::size_t number) {
    const DampedMode& mode = analysis.modes[number];
    SceneRun run;
    run.name = "mode " + std::to_string(number + 1) + ", " + formatNumber(mode.frequency, 4) + " Hz";
    run.stations = {{mode.frequency, 0, 1 / (mode.frequency * kFrames), 0, kFrames}};
    run.mobile.resize(6, kFrames);
    run.fixed = Eigen::MatrixXd::Zero(6, kFrames);
    const Eigen::Index connections = analysis.model.connections.size();
    run.force = Eigen::MatrixXd::Zero(3 * connections, kFrames);
    run.closed = Eigen::MatrixXi::Zero(analysis.sag.stops.size(), kFrames);
    const double amplitude = findAmplitude(analysis, mode);
    for (Eigen::Index frame = 0; frame < kFrames; ++frame) {
        const double angle = kTwoPi * static_cast<double>(frame) / kFrames;
        const Eigen::VectorXd x = amplitude * (mode.shape * std::polar(1.0, angle)).real();
        run.mobile.col(frame) = analysis.system.mobile_frame * x;
        run.fixed.col(frame) = analysis.system.fixed_frame * x;
    }
    return run;
}

/// One picture for each group of three outputs of all connections along one axis.
template <class Value>
std::vector<Plot> plotOutputs(const LinearAnalysis& analysis, const std::vector<double>& frequency,
                              const std::string& what, const std::string& per, const Value& value) {
    struct Group {
        const char* title;
        const char* unit;
        double factor;
        Eigen::Index row;
    };
    const Group groups[] = {{"relative displacement", "mm", 1e3, 0},
                            {"connection force", "N", 1, 3},
                            {"acceleration of the mobile part", "m/s^2", 1, 6},
                            {"acceleration of the fixed part", "m/s^2", 1, 9}};
    std::vector<Plot> plots;
    for (const Group& group : groups)
        for (Eigen::Index axis = 0; axis < 3; ++axis) {
            Plot plot;
            plot.title = what + ", " + group.title + " " + "xyz"[axis];
            plot.x_label = "frequency [Hz]";
            plot.y_label =
                std::string("[") + (per == "^2/Hz" ? "(" + std::string(group.unit) + ")" : group.unit) + per + "]";
            plot.log_y = true;
            double largest = 0;
            for (std::size_t i = 0; i < analysis.model.connections.size(); ++i) {
                Series series{analysis.model.connections[i].name, frequency, {}};
                const Eigen::Index row = kOutputsPerConnection * static_cast<Eigen::Index>(i) + group.row + axis;
                for (std::size_t k = 0; k < frequency.size(); ++k) {
                    series.y.push_back(value(row, k, group.factor));
                    largest = std::max(largest, series.y.back());
                }
                plot.series.push_back(std::move(series));
            }
            constexpr double nothing = 1e-12;  // where symmetry leaves rounding alone
            if (largest > nothing) plots.push_back(std::move(plot));
        }
    return plots;
}

}  // namespace

void writeAnalysisReport(const LinearAnalysis& analysis, const std::vector<DrawnShape>& drawing,
                         const std::string& file, OutputFiles& outputs) {
    HtmlReport page("Linear model of " + analysis.model.name);
    const DampedMode* first = nullptr;
    for (const DampedMode& mode : analysis.modes)
        if (first == nullptr && mode.frequency > 0) first = &mode;
    if (first != nullptr)
        page.addLead("The lowest mode lies at " + formatNumber(first->frequency, 4) + " Hz with " +
                     formatNumber(100 * first->damping_ratio, 3) + " % damping.");
    page.addText(
        "Small motions about the rest position under gravity: stops that are not touched there do not act. Effective "
        "mass: "
        "the part of the mass that a motion of the base along an axis sets moving in this mode.");
    Table modes({"mode", "frequency [Hz]", "damping [%]", "rings at [Hz]", "mass x [kg]", "mass y [kg]", "mass z [kg]",
                 "moves most"});
    for (std::size_t i = 0; i < analysis.modes.size(); ++i) {
        const DampedMode& mode = analysis.modes[i];
        std::vector<std::string> row{std::to_string(i + 1), formatNumber(mode.frequency, 5),
                                     formatNumber(100 * mode.damping_ratio, 4),
                                     mode.damped_frequency > 0 ? formatNumber(mode.damped_frequency, 5) : "-"};
        for (const double mass : mode.effective_mass) row.push_back(mass < 1e-6 ? "0" : formatNumber(mass, 3));
        row.push_back(describeShape(analysis, mode));
        modes.addRow(row);
    }
    page.addTable(modes.header(), modes.rows());
    page.addHeading("Rest position");
    if (analysis.model.gravity.isZero()) page.addText("Without gravity: the unloaded position.");
    Table stops({"stop", "clearance [mm]", "left at rest [mm]"});
    for (const StopMargin& stop : analysis.sag.stops)
        stops.addRow(
            {nameStop(analysis.model, stop), formatNumber(1e3 * stop.clearance, 4), formatNumber(1e3 * stop.left, 4)});
    if (!stops.empty()) page.addTable(stops.header(), stops.rows());

    MotionScene scene;
    scene.title = "Mode shapes";
    scene.model = analysis.model;
    scene.drawing = drawing;
    for (std::size_t i = 0; i < analysis.modes.size(); ++i)
        if (analysis.modes[i].frequency > 0) scene.runs.push_back(makeModeRun(analysis, i));
    page.addHeading("Mode shapes");
    page.addText("Each mode as large as just touches a stop, exaggerated about the rest position.");
    if (!scene.runs.empty()) page.addScene(scene);
    if (analysis.transfer) {
        page.addHeading("Transfer functions");
        const TransferFunctions& transfer = *analysis.transfer;
        page.addText("For each " + transfer.input_unit + " of " + transfer.input + ", relative to rest.");
        for (const Plot& plot :
             plotOutputs(analysis, transfer.frequency, "Amplitude for each " + transfer.input_unit,
                         "/(" + transfer.input_unit + ")", [&](Eigen::Index row, Eigen::Index k, double factor) {
                             return factor * std::abs(transfer.response(row, k));
                         }))
            page.addPlot(plot);
    }
    if (analysis.random) {
        page.addHeading("Random response");
        page.addText(analysis.random_input);
        const RandomResponse& random = *analysis.random;
        for (const Plot& plot : plotOutputs(analysis, random.frequency, "Density", "^2/Hz",
                                            [&](Eigen::Index row, Eigen::Index k, double factor) {
                                                return factor * factor * random.density(row, k);
                                            }))
            page.addPlot(plot);
    }
    page.write(file, outputs);
}

}  // namespace wems::plugin
