/// @file
/// The cubic spring at the tip of a beam from the equation of motion of the tip's deflection alone, complete and
/// truncated.
///
///     complete   Σ_j M[w, j] q_j'' + κ Σ_j K[w, j] q_j + β Σ_j K[w, j] q_j' + k₃ w³ = 0,   j: w and θ of the last two
///     nodes truncated  M[w, w] w'' + k w + c w' + k₃ w³ = 0
///
/// M and K are the beam's matrices. In the complete equation κ should come out as 1. The truncated one leaves out what
/// the neighbour and the rotations do: it shows the shape of the spring and no more. Source: Noël, Kerschen, Newerla,
/// IMAC XXX (2012), section 3.1.
#pragma once

#include <Eigen/Core>

#include "models/beam/beam.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

struct TipSpring {
    double cubic = 0;              ///< k₃, N/m³
    double stiffness = 0;          ///< κ (-) or k (N/m)
    double damping = 0;            ///< β (s) or c (N s/m)
    double residual_fraction = 0;  ///< of the inertia force
    Eigen::VectorXd deflection,
        force;  ///< m, N: inertia force less the identified linear terms, over the tip's deflection
};

struct BeamTip {
    TipSpring complete, truncated;
};

/// @param recording as simulateBeam() writes it: z, vz, az, x, vx, ax of the last two nodes
/// @throws InputError naming the channel that is missing.
BeamTip identifyBeamTip(const Recording& recording, const Beam& beam);

}  // namespace wems::identify
