/// @file
/// Natural modes of the linear model with its damping: eigenvalues of the state space x, x', z (z the internal states
/// of Maxwell branches and structural damping).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/linear_modes.hpp"

namespace wems {

/// The pole λ = 2π f (−ζ + i √(1 − ζ²)) and what belongs to it.
struct DampedMode {
    double frequency = 0;           ///< f = |λ|/2π, Hz; without damping the natural frequency
    double damping_ratio = 0;       ///< ζ; from 1 on the mode does not oscillate
    double damped_frequency = 0;    ///< Hz, at which it rings; 0 if it does not oscillate
    double undamped_frequency = 0;  ///< Hz, of the normal mode that belongs to it
    Eigen::VectorXcd shape;         ///< x of LinearSystem; its largest motion of a connection's end is 1
    Eigen::VectorXd normal_shape;   ///< of the normal mode, φᵀ M φ = 1
    /// kg, of the normal mode for a motion of the base along x, y, z: (φᵀ M r)². Summed over all modes they give the
    /// mobile part's mass and, where the modes file has base columns, the bracket's mass in these modes.
    Eigen::Vector3d effective_mass = Eigen::Vector3d::Zero();
};

/// d/dt (x, x', z) = A (x, x', z). @param system of linearizeExactly()
Eigen::MatrixXd makeStateMatrix(const LinearSystem& system);

/// One for each coordinate, frequency ascending. Normal modes (spin and damping left out) take the branches' storage
/// stiffness at their own frequency; each pole is given the normal mode whose shape it resembles most. A coordinate
/// that nothing holds has frequency 0. Of a mode that does not oscillate frequency and ratio come from the normal mode,
/// ζ = φᵀ C φ / 2ω.
/// @param system of linearizeExactly() @throws InputError if the equilibrium is not stable.
std::vector<DampedMode> findDampedModes(const LinearSystem& system);

}  // namespace wems
