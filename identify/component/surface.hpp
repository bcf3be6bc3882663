/// @file
/// What kind of element a restoring force surface shows, and the figures that belong to that kind.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identify/component/component_data.hpp"
#include "identify/component/component_fit.hpp"

namespace wems::identify {

/// A law that was tried on the surface.
struct SurfaceCandidate {
    std::string name;        ///< `linear`, `cubic`, `one breakpoint`, `two breakpoints`, each also `… + friction`
    double fraction = 0;     ///< RMS of what it leaves over that of f about its mean
    double information = 0;  ///< Bayesian information criterion with the effective number of samples; lower is better
    int parameters = 0;
};

struct SurfaceKind {
    /// linear; hardening; softening; piecewise linear, stiffening; piecewise linear, softening; clearance; viscous;
    /// friction; friction with gap at reversals; hysteresis
    std::string name;
    std::string statement;                       ///< one sentence that says what was seen
    std::vector<ComponentParameter> parameters;  ///< of the kind that was named
    std::vector<SurfaceCandidate> candidates;
    GainTolerances gains;          ///< which no interval of `parameters` knows
    double effective_samples = 0;  ///< samples over the correlation length of the best law's residual
    double history_fraction =
        0;  ///< left by a curve over direction and travel since the reversal, full strokes; NaN without
    StrokeSummary strokes;
};

/// Tries the laws in order of complexity and takes the simplest whose criterion is within 6 of the best. Its name is of
/// what makes most of the force: displacement, velocity (viscous) or direction (friction).
/// A surface is named friction from its strokes: levels of opposite sign, flat, enclosing an area, and either followed
/// by a law with a friction term or, better than by any law of (q, v), by the travel since the last reversal.
/// `low_force` (N): see summariseFriction.
SurfaceKind characteriseSurface(const ComponentData& data, double low_force = 0);

// The restoring force surface without any law: medians of f over cells of (q, v), and two slices of it.
// Source: Masri, Caughey (1979), doi:10.1115/1.3424568; Duym, Schoukens, Guillaume (1996).

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
