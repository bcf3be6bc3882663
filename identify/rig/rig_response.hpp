/// @file
/// The free response of a rig that moves along one axis:
///
///     m q'' + Σ_i [f_i(q₀ + q, q') − f_i(q₀, 0)] = u(t) − m a(t)
///
/// q the relative displacement from rest, q₀ that of rest (under gravity), u the load along the axis times its gain, a
/// the acceleration of the fixed part. Runge–Kutta of fourth order; between samples u and a are cubic Hermite
/// polynomials with slopes of fourth order, as in identify/forward/drive.hpp. Sixty times as fast as the forward model
/// of six motions.
#pragma once

#include <Eigen/Core>

#include "models/mount_model.hpp"

namespace wems::identify {

struct RigRun {
    double interval = 0;                   ///< s
    Eigen::VectorXd load;                  ///< N; empty: none
    Eigen::VectorXd acceleration;          ///< m/s², of the fixed part; empty: none
    Eigen::Index count = 0;                ///< samples
    double start = 0, start_velocity = 0;  ///< m, m/s, relative, from rest
};

/// q at the samples, m; stays at its last value from where it is no number.
Eigen::VectorXd simulateRig(const MountModel& model, int axis, const RigRun& run);

}  // namespace wems::identify
