#include "identify/commands/surface_report.hpp"

#include <algorithm>
#include <cmath>

#include "identify/commands/component_fit.hpp"
#include "identify/component/surface_grid.hpp"
#include "models/format_number.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::commands {
namespace {

constexpr int kFewestCells = 12, kMostCells = 32;  // each way …
constexpr double kSamplesPerCell = 12;             // … so that cells are filled

Eigen::VectorXd findMiddles(const Eigen::VectorXd& edges) {
    return 0.5 * (edges.head(edges.size() - 1) + edges.tail(edges.size() - 1));
}

std::vector<double> scale(const Eigen::VectorXd& values, double factor) {
    const Eigen::VectorXd scaled = factor * values;
    return {scaled.begin(), scaled.end()};
}

std::vector<double> scale(const std::vector<double>& values, double factor) {
    return scale(Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(values.data(), values.size())), factor);
}

}  // namespace

ForceSurface makeEmptySurface(const std::string& title) {
    ForceSurface surface;
    surface.title = title;
    surface.displacement_label = "displacement [mm]";
    surface.velocity_label = "velocity [m/s]";
    surface.force_label = "force [N]";
    return surface;
}

void addSheet(ForceSurface& surface, const std::string& name, const ComponentData& data, bool points, int color) {
    const double filled = std::sqrt(static_cast<double>(data.q.size()) / kSamplesPerCell);
    const int cells = std::clamp(static_cast<int>(filled), kFewestCells, kMostCells);
    const SurfaceGrid grid = makeSurfaceGrid(data, cells, cells);
    surface.displacement = 1e3 * findMiddles(grid.q_edges);
    surface.velocity = findMiddles(grid.v_edges);
    surface.sheets.push_back({name, grid.median, points, color});
}

void writeSurfaceReport(const ComponentData& data, const SurfaceKind& kind, const std::string& file,
                        OutputFiles& outputs) {
    constexpr int cells = 60;
    const std::vector<double> force = scale(data.force, 1), displacement = scale(data.q, 1e3);
    HtmlReport report("Restoring force surface: " + data.file);
    std::string lead = "Connection " + data.connection + ", axis " + "xyz"[data.axis] + ": " + kind.name;
    if (!kind.parameters.empty())
        lead += ", " + kind.parameters.front().name + " " + formatNumber(kind.parameters.front().value, 4) + " " +
                kind.parameters.front().unit;
    report.addLead(lead + ".");
    report.addText(kind.statement);
    if (data.qualitative) report.addText("Qualitative: other connections act on the same body.");
    const Table parameters = tabulateParameters(kind.parameters);
    report.addTable(parameters.header(), parameters.rows());
    report.addPlot(
        {"Force over displacement", "displacement [mm]", "force [N]", {{"force", displacement, force}}, true});
    const SurfaceSlice stiffness = sliceStiffness(data, cells), damping = sliceDamping(data, cells);
    report.addPlot({"Stiffness curve: slow samples",
                    "displacement [mm]",
                    "median force [N]",
                    {{"median", scale(stiffness.at, 1e3), stiffness.force}}});
    if (data.has_velocity) {
        report.addPlot(
            {"Force over velocity", "velocity [m/s]", "force [N]", {{"force", scale(data.velocity, 1), force}}, true});
        report.addPlot({"Damping curve: samples near rest position",
                        "velocity [m/s]",
                        "median force [N]",
                        {{"median", damping.at, damping.force}}});
        ForceSurface surface = makeEmptySurface("Restoring force surface: medians over displacement and velocity");
        addSheet(surface, "median force", data, false, 0);
        report.addSurface(surface);
    }
    report.addPlot({"Force over travel since the last reversal",
                    "travel [mm]",
                    "force [N]",
                    {{"force", scale(calcTravel(data.q, 0.05), 1e3), force}},
                    true});
    for (const auto& note : data.notes) report.addText(note);
    report.write(file, outputs);
}

}  // namespace wems::identify::commands
