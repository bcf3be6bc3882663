/// @file
/// What the scatter of the channels' gains does to a solution of the regression.
///
/// A gain error g_c of channel c moves the rigid motion by P_c s_c g_c, P_c the c-th column of the rigid fit's
/// pseudo-inverse and s_c the channel's signal; the residual follows to first order, through the laws' tangent
/// stiffness and dashpots, and through the body's mass matrix where the channel decides the acceleration. All runs
/// share the gains: they were recorded with the same sensors.
#pragma once

#include <Eigen/Core>

#include "identify/fit/solver.hpp"

namespace wems::identify {

struct CalibrationEffect {
    /// Change of the scaled parameters for one standard deviation of each channel's gain: parameters x channels. No
    /// column where no scatter was noticed (Calibration::gain_scatter).
    Eigen::MatrixXd influences;
    double residual_squares = 0;  ///< sum of squares of the whitened residual that the scatter leaves on average
};

CalibrationEffect calcCalibrationEffect(const Solver& solver, const LinearSystem& system);

}  // namespace wems::identify
