/// @file
/// A clamped-free beam of two-dimensional (Euler–Bernoulli) finite elements with a cubic spring at its tip.
///
///     M q'' + C q' + K q + e_tip k₃ w_tip³ = e_load F,      C = β K
///
/// Two coordinates for each free node i = 1 … n: deflection w_i (m) and rotation θ_i (rad); q = (w_1, θ_1, …, w_n,
/// θ_n). Hermite shape functions, consistent mass: with l = L/n the element's mass and stiffness are
///
///     ρAl/420 [156 22l 54 −13l; 22l 4l² 13l −3l²; 54 13l 156 −22l; −13l −3l² −22l 4l²]
///     EI/l³   [12 6l −12 6l; 6l 4l² −6l 2l²; −12 −6l 12 −6l; 6l 2l² −6l 4l²]
///
/// The cubic spring stands for the thin beam at the tip of the benchmark of Kerschen, Lenaerts and Golinval (2003),
/// doi:10.1006/mssp.2002.1151, whose main beam (0.7 m × 14 mm × 14 mm, steel) the defaults describe.
#pragma once

#include <Eigen/Core>

#include "models/excitation.hpp"
#include "models/recording/recording.hpp"

namespace wems {

struct Beam {
    int elements = 10;
    double length = 0.7;                ///< m
    double width = 0.014;               ///< m
    double thickness = 0.014;           ///< m, in the direction of the deflection
    double modulus = 2.05e11;           ///< Pa
    double density = 7800;              ///< kg/m³
    double stiffness_damping = 6.0e-5;  ///< β, s
    double tip_cubic = 8.0e9;           ///< k₃, N/m³
    int load_node = 3;

    int coordinates() const { return 2 * elements; }
    static int deflection(int node) { return 2 * (node - 1); }
    static int rotation(int node) { return 2 * (node - 1) + 1; }
};

struct BeamMatrices {
    Eigen::MatrixXd mass, stiffness;  ///< clamped node left out
};
BeamMatrices assembleBeam(const Beam& beam);

/// Undamped natural frequencies without the tip spring, Hz, ascending.
Eigen::VectorXd findBeamFrequencies(const Beam& beam);

// Response of the beam to a force, and its recording.

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
