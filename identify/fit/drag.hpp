/// @file
/// What motion drags along (models/axis_law.hpp), moved over one interval of a recorded motion.
#pragma once

#include "identify/forward/kinks.hpp"
#include "models/axis_law.hpp"

namespace wems::identify {

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
