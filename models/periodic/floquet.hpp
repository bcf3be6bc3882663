/// @file
/// Stability of a periodic motion: the Floquet multipliers of the equations of motion linearised along it.
#pragma once

#include <Eigen/Core>

#include "models/periodic/harmonic_balance.hpp"

namespace wems {

/// Eigenvalues of the map of a small disturbance of (x, x', internal states) over one period; the motion is stable if
/// all lie within the unit circle. Largest first. They are exp(2π α/ω) of Hill's exponents α.
///
/// The disturbance obeys M y'' + (C + Σ J_aᵀ ∂n/∂q' J_a) y' + (K + Σ J_aᵀ ∂n/∂q J_a) y + branches = 0, integrated by
/// the implicit midpoint rule over the samples of the balance; a mode of frequency f then turns by (2π f/(f₀ N))²/12 of
/// its angle too little, f₀ the motion's frequency and N the samples.
Eigen::VectorXcd calcFloquetMultipliers(const HarmonicBalance& balance, const Eigen::VectorXd& Q, double frequency);

/// Where the largest multiplier lies outside of the unit circle: beyond +1 (between two folds, or where a symmetric
/// motion has lost its symmetry), beyond −1 (the period doubles), elsewhere (a second frequency appears:
/// quasi-periodic).
enum class Instability { none, real, period_doubling, neimark_sacker };
Instability findInstability(const Eigen::VectorXcd& multipliers);

}  // namespace wems
