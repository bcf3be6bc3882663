/// @file
/// The device linearised about its static equilibrium: matrices and natural frequencies.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/mount_model.hpp"

namespace wems {

/// A Maxwell branch that acts on the displacement q = ends[connection].row(axis) x: force g (q − z), z' = (q − z)/τ.
struct LinearBranch {
    int connection = 0, axis = 0;
    MaxwellBranch branch{0, 0};
};

/// M x'' + C x' + K x = B F with x = (displacement of Mo in G, m; small rotation of M about the axes of G, rad; modal
/// coordinates of the bracket, kg^1/2 m), counted from rest, and F the load where the model has it act (N). Of a guided
/// mobile part (models/guided_motion.hpp) its free coordinates relative to F take the place of the first six.
///
/// K holds the geometric stiffness of gravity. Internal states (relaxation, structural damping) enter as storage and
/// loss at one reference frequency, kept frozen otherwise; C holds the loss, the dashpots, friction at its slope at
/// rest, the modes' damping, and the wheel's spin (skew). Stops that are not touched at rest do not act.
struct LinearSystem {
    Eigen::MatrixXd mass, damping, stiffness;
    Eigen::MatrixXd load;  ///< B, rows as x, 3 columns
    Eigen::MatrixXd base;  ///< generalized force for each m/s² of base acceleration; x is relative to the base
    std::vector<Eigen::MatrixXd> ends;  ///< q_i = ends[i] x: relative displacement of each connection, F axes
    std::vector<Eigen::MatrixXd> mobile_ends, fixed_ends;  ///< displacement of both ends of each connection, G axes
    Eigen::MatrixXd mobile_frame,
        fixed_frame;                     ///< displacement of Mo and Fo, small rotations of M and F: 6 rows, G axes
    std::vector<LinearBranch> branches;  ///< empty where they are frozen in C and K
};

/// @param reference_frequency Hz, at which internal states are evaluated
/// @throws InputError if the model has no static equilibrium.
LinearSystem linearize(const MountModel& model, double reference_frequency);

/// The same, exact at every frequency: internal states of relaxation and structural damping are `branches`, of which C
/// and K hold nothing.
LinearSystem linearizeExactly(const MountModel& model);

/// Undamped natural modes: K φ = ω² M φ.
struct LinearModes {
    Eigen::VectorXd frequency;  ///< Hz, ascending
    Eigen::MatrixXd shape;      ///< columns, φᵀ M φ = 1
};
/// Spin and damping are left out. @throws InputError if the equilibrium is not stable.
LinearModes findLinearModes(const LinearSystem& system);

}  // namespace wems
