#include "identify/component/surface_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wems::identify {
namespace {

double takeMedian(std::vector<double>& values) {
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

Eigen::VectorXd makeEdges(const Eigen::VectorXd& values, int cells) {
    double low = values.minCoeff(), high = values.maxCoeff();
    if (high <= low) high = low + 1;  // a single cell catches all: no velocity was recorded
    return Eigen::VectorXd::LinSpaced(cells + 1, low, high);
}

Eigen::Index findCell(const Eigen::VectorXd& edges, double value) {
    const Eigen::Index cells = edges.size() - 1;
    const double place = (value - edges[0]) / (edges[cells] - edges[0]) * static_cast<double>(cells);
    return std::clamp(static_cast<Eigen::Index>(std::floor(place)), Eigen::Index{0}, cells - 1);
}

/// Medians of f over cells of `along`, of the samples where |across| is below a tenth of its maximum.
SurfaceSlice slice(const Eigen::VectorXd& along, const Eigen::VectorXd& across, const Eigen::VectorXd& force,
                   int cells) {
    SurfaceSlice result;
    result.half_width = 0.1 * across.cwiseAbs().maxCoeff();
    const Eigen::VectorXd edges = makeEdges(along, cells);
    std::vector<std::vector<double>> bins(cells);
    for (Eigen::Index i = 0; i < along.size(); ++i)
        if (std::abs(across[i]) <= result.half_width) bins[findCell(edges, along[i])].push_back(force[i]);
    for (std::size_t c = 0; c < bins.size(); ++c) {
        if (bins[c].empty()) continue;
        const Eigen::Index k = c;
        result.at.push_back(0.5 * (edges[k] + edges[k + 1]));
        result.count.push_back(static_cast<long>(bins[c].size()));
        result.force.push_back(takeMedian(bins[c]));
    }
    return result;
}

}  // namespace

SurfaceGrid makeSurfaceGrid(const ComponentData& data, int q_cells, int v_cells) {
    SurfaceGrid grid;
    grid.q_edges = makeEdges(data.q, q_cells);
    grid.v_edges = makeEdges(data.velocity, v_cells);
    grid.median.resize(q_cells, v_cells);
    grid.count = Eigen::MatrixXi::Zero(q_cells, v_cells);
    std::vector<std::vector<double>> bins(static_cast<std::size_t>(q_cells) * static_cast<std::size_t>(v_cells));
    const auto binOf = [&](Eigen::Index i) {
        return static_cast<std::size_t>(findCell(grid.q_edges, data.q[i]) * v_cells +
                                        findCell(grid.v_edges, data.velocity[i]));
    };
    for (Eigen::Index i = 0; i < data.count(); ++i) bins[binOf(i)].push_back(data.force[i]);
    std::vector<double> medians(bins.size());
    for (std::size_t b = 0; b < bins.size(); ++b) {
        const auto row = static_cast<Eigen::Index>(b) / v_cells, column = static_cast<Eigen::Index>(b) % v_cells;
        grid.count(row, column) = static_cast<int>(bins[b].size());
        medians[b] = takeMedian(bins[b]);
        grid.median(row, column) = medians[b];
    }
    double left = 0;
    for (Eigen::Index i = 0; i < data.count(); ++i) left += std::pow(data.force[i] - medians[binOf(i)], 2);
    const double spread = (data.force.array() - data.force.mean()).matrix().squaredNorm();
    grid.fraction = spread > 0 ? std::sqrt(left / spread) : 0.0;
    return grid;
}

SurfaceSlice sliceStiffness(const ComponentData& data, int cells) {
    return slice(data.q, data.velocity, data.force, cells);
}

SurfaceSlice sliceDamping(const ComponentData& data, int cells) {
    return slice(data.velocity, data.q, data.force, cells);
}

}  // namespace wems::identify
