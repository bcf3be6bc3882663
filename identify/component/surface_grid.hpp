/// @file
/// The restoring force surface without any law: medians of f over cells of (q, v), and two slices of it.
/// Source: Masri, Caughey (1979), doi:10.1115/1.3424568; Duym, Schoukens, Guillaume (1996).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/component/component_data.hpp"

namespace wems::identify {

/// Cells of equal size over the range of q and of v. Cell (i, j): q between q_edges[i] and [i+1], v likewise.
struct SurfaceGrid {
    Eigen::VectorXd q_edges, v_edges;  ///< m, m/s
    Eigen::MatrixXd median;            ///< N, q cells x v cells; NaN where `count` is zero
    Eigen::MatrixXi count;
    double fraction = 0;  ///< what the cell medians leave of f: RMS over that of f about its mean
};

/// A curve through the surface.
struct SurfaceSlice {
    double half_width = 0;  ///< of the slab that was cut: m/s for the stiffness curve, m for the damping curve
    std::vector<double> at, force;
    std::vector<long> count;
};

SurfaceGrid makeSurfaceGrid(const ComponentData& data, int q_cells, int v_cells);

/// f over q where |v| is below a tenth of its maximum.
SurfaceSlice sliceStiffness(const ComponentData& data, int cells);

/// f over v where |q| is below a tenth of its maximum.
SurfaceSlice sliceDamping(const ComponentData& data, int cells);

}  // namespace wems::identify
