/// @file
/// Response of the beam to a force, and its recording.
#pragma once

#include "models/beam/beam.hpp"
#include "models/excitation.hpp"
#include "models/recording/recording.hpp"

namespace wems {

struct BeamRun {
    double force = 0;           ///< N, amplitude at the load node
    double sample_rate = 5000;  ///< Hz
    int steps_per_sample = 4;
};

/// Implicit Newmark (average acceleration), the cubic force by Newton's method in each step, so that the equation of
/// motion holds at every sample to round-off. Starts at rest.
///
/// The recording has the last two nodes, numbered from the clamp: `mobile.<node>.z|vz|az` is the deflection, and
/// `mobile.<node>.x|vx|ax` the motion along the beam of the point on its upper surface, −(thickness/2) θ, which is how
/// rotations are measured. `load.fz` is the force.
Recording simulateBeam(const Beam& beam, const Signal& signal, const BeamRun& run);

}  // namespace wems
