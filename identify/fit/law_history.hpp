/// @file
/// What the laws of a model make of a measured relative motion: the parts of each axis force that a fit scales, and the
/// parts that it takes as known.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/forward/kinks.hpp"
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
/// between samples, what is dragged as identify/fit/law_history.hpp says.
LawHistory calcLawHistory(const MountModel& model, const RelativeHistory& relative, const std::vector<double>& time);

/// The model's whole force of each axis (sign of q) along the measured motion, N; internal states as above.
RowMatrix calcForceHistory(const MountModel& model, const RelativeHistory& relative, const std::vector<double>& time);

// What motion drags along (models/axis_law.hpp), moved over one interval of a recorded motion.

/// Over the cubic through both ends with their velocities. Where the velocity changes its sign the motion turns on the
/// way, once; otherwise what counts is the travel.
inline void dragAlong(const AxisForce& force, const AxisStep<double>& step, double* z) {
    double on_the_way = step.q1;
    if (step.v0 * step.v1 < 0) {
        const double sign = step.v0 > 0 ? 1.0 : -1.0;
        const double part = findKink([&](double at) { return sign * step.velocity(at); }, false);
        if (part < 1) on_the_way = step.displacement(part);
    }
    force.dragStates(on_the_way - step.q0, z);
    if (on_the_way != step.q1) force.dragStates(step.q1 - on_the_way, z);
}

}  // namespace wems::identify
