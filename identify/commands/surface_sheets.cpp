#include "identify/commands/surface_sheets.hpp"

#include <algorithm>
#include <cmath>

#include "identify/component/surface_grid.hpp"

namespace wems::identify::commands {
namespace {

constexpr int kFewestCells = 12, kMostCells = 32;  // each way …
constexpr double kSamplesPerCell = 12;             // … so that cells are filled

Eigen::VectorXd findMiddles(const Eigen::VectorXd& edges) {
    return 0.5 * (edges.head(edges.size() - 1) + edges.tail(edges.size() - 1));
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

}  // namespace wems::identify::commands
