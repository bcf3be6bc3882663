/// @file
/// What the laws of a model make of a measured relative motion: the parts of each axis force that a fit scales, and the
/// parts that it takes as known.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/motion/motion.hpp"
#include "models/axis_law.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Relative displacements and velocities of all connections over a run, in F axes; row k belongs to sample k, column
/// 3 i + a to axis a of connection i.
struct RelativeHistory {
    RowMatrix q;  ///< m
    RowMatrix v;  ///< m/s
};
RelativeHistory calcRelativeHistory(const RunMotion& motion, const MountModel& model);

/// Forces of each axis (columns as above) along the measured motion.
struct LawHistory {
    /// Elastomer force for a stiffness of 1 N/m: q, or with drift, relaxation and loss factor as the model has them.
    RowMatrix unit_elastic;
    /// What no parameter of the fit scales: cubic term, friction, hysteresis, any second stop on the same side, N.
    RowMatrix known;
    bool elastic_is_displacement = true;  ///< unit_elastic equals q and is left empty
    bool known_is_zero = true;            ///< known is zero and is left empty
};
/// Internal states follow the measured displacement from relaxed at the first sample on: branches as if it were linear
/// between samples, what is dragged as `dragAlong` (models/sampled_motion.hpp) says.
LawHistory calcLawHistory(const MountModel& model, const RelativeHistory& relative, const std::vector<double>& time);

/// The model's whole force of each axis (sign of q) along the measured motion, N; internal states as above.
RowMatrix calcForceHistory(const MountModel& model, const RelativeHistory& relative, const std::vector<double>& time);

}  // namespace wems::identify
