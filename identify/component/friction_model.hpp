/// @file
/// A friction element with presliding and backlash in series: what a friction damper with play does.
///
/// One internal state e (m), the deflection of the part that sticks, follows the motion and is held between limits,
///
///     e' = v,  −(s + g/2) ≤ e ≤ s + g/2
///
/// with s the presliding deflection (spring travel from zero force to sliding) and g the gap; the force is
///
///     f =  F₊ (e − g/2) / s   for e >  g/2
///     f =  0                  for |e| ≤ g/2
///     f =  F₋ (e + g/2) / s   for e < −g/2
///
/// so that it slides at F₊ towards + and at −F₋ towards −. It does not depend on the speed; without gap it is a Jenkins
/// (Prandtl) element with two levels. Sources: Prandtl (1928); Iwan (1966), doi:10.1115/1.3625199; play:
/// Krasnosel'skii, Pokrovskii, Systems with Hysteresis (1989).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/component/component_data.hpp"
#include "identify/component/component_fit.hpp"

namespace wems::identify {

struct FrictionGapLaw {
    double positive_level = 0;  ///< F₊, N
    double negative_level = 0;  ///< F₋, N, positive
    double presliding = 0;      ///< s, m, > 0
    double gap = 0;             ///< g, m, ≥ 0
};

/// Force along a motion that begins in the middle of the gap.
Eigen::VectorXd simulateFriction(const FrictionGapLaw& law, const Eigen::VectorXd& q);

/// Root of the sum of squares of (simulated − measured) over that of the measured force.
double calcRelativeError(const FrictionGapLaw& law, const ComponentData& data);

struct FrictionGapFit {
    FrictionGapLaw law;
    std::vector<ComponentParameter> parameters;  ///< with intervals from blocks of residuals
    double relative_error = 0;                   ///< over all tests of the fit together
};

/// Least squares of the force: the levels are linear, s and g come from a search over their plane.
/// @param with_gap false holds g at zero, for comparison
FrictionGapFit fitFrictionGap(const std::vector<ComponentData>& tests, bool with_gap);

}  // namespace wems::identify
