/// @file
/// What small changes of the measured motion make of a run's equations, to first order about the measured motion: the
/// laws' tangent stiffness and dashpots along it, and the body's mass matrix.
#pragma once

#include <Eigen/Core>

#include "identify/fit/equation_of_motion.hpp"
#include "identify/motion/motion.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

struct LinearResponse {
    Eigen::MatrixXd tangent;                              ///< axes x samples, N/m; stops included where they touch
    Eigen::Matrix<double, 6, Eigen::Dynamic> directions;  ///< of each axis: force above moment about M's origin, per N
    Eigen::VectorXd damping;                              ///< of each axis, N s/m
    Matrix6d mass;                                        ///< about M's origin, translation above rotation, at rest
};

LinearResponse makeLinearResponse(const RunMotion& motion, const MountModel& model);

}  // namespace wems::identify
