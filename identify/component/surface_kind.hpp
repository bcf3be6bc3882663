/// @file
/// What kind of element a restoring force surface shows, and the figures that belong to that kind.
#pragma once

#include <string>
#include <vector>

#include "identify/component/component_data.hpp"
#include "identify/component/component_parameter.hpp"
#include "identify/component/reversals.hpp"

namespace wems::identify {

/// A law that was tried on the surface.
struct SurfaceCandidate {
    std::string name;        ///< `linear`, `cubic`, `one breakpoint`, `two breakpoints`, each also `… + friction`
    double fraction = 0;     ///< RMS of what it leaves over that of f about its mean
    double information = 0;  ///< Bayesian information criterion with the effective number of samples; lower is better
    int parameters = 0;
};

struct SurfaceKind {
    /// linear; hardening; softening; piecewise linear, stiffening; piecewise linear, softening; clearance; friction;
    /// friction with gap at reversals; hysteresis; of nameByMemory() also viscoelastic, unexplained
    std::string name;
    std::string statement;                       ///< one sentence that says what was seen
    std::vector<ComponentParameter> parameters;  ///< of the kind that was named
    std::vector<SurfaceCandidate> candidates;
    double effective_samples = 0;  ///< samples over the correlation length of the best law's residual
    double history_fraction =
        0;  ///< left by a curve over direction and travel since the reversal, full strokes; NaN without
    StrokeSummary strokes;
};

/// Tries the laws in order of complexity and names the simplest whose criterion is within 6 of the best.
/// A surface is named friction from its strokes: levels of opposite sign, flat, enclosing an area, and either followed
/// by a law with a friction term or, better than by any law of (q, v), by the travel since the last reversal.
/// `low_force` (N): see summariseFriction.
SurfaceKind characteriseSurface(const ComponentData& data, double low_force = 0);

}  // namespace wems::identify
