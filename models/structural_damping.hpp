/// @file
/// Maxwell branches whose loss modulus is nearly constant over a band: structural damping in the time domain.
///
/// A branch of stiffness g with time constant τ has, at the angular frequency ω and with u = ω τ, the storage modulus
/// g u²/(1 + u²) and the loss modulus g u/(1 + u²). Three branches with corner frequencies f_m/κ, f_m, κ f_m, where f_m
/// is the geometric middle of the band, and stiffnesses by linear least squares over the band (41 frequencies, equally
/// spaced in log f) give a loss modulus of 1 within 0.2 % over one decade. κ = 4.89 is where that ripple is smallest:
/// the outer corners lie a factor 1.55 outside of the band.
#pragma once

#include <array>

#include "models/axis_law.hpp"

namespace wems {

/// The branches for a loss modulus of 1 N/m in the middle of structuralBand().
struct StructuralBranches {
    std::array<MaxwellBranch, 3> branch;
    double storage_in_middle;  ///< storage modulus of all branches there, N/m
};
const StructuralBranches& structuralBranches();

}  // namespace wems
