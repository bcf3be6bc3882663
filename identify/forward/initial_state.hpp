/// @file
/// Where a free simulation starts from: rest, or what a recording that begins in motion shows of its first instant.
#pragma once

#include <optional>

#include "identify/forward/forward_model.hpp"
#include "identify/motion/motion.hpp"

namespace wems::identify {

/// Motion of both parts at the first sample, as measured: of no model, so that it serves while parameters change.
struct StartMotion {
    BodyMotion mobile;
    FrameMotion fixed;
};

/// The motion at the first sample, if it is not rest: nullopt where the relative displacement there and what its
/// velocity makes of it over the samples of the fit are within the noise (6 standard deviations of the fit) or within
/// 0.2 % of the run's largest, from its median over the run, which a sensor's zero shifts alike; and where
/// displacements were not measured, or a base acceleration drives: what is integrated does not know its start.
///
/// Positions and velocities are least squares over the first samples: with accelerations measured x₀ + v₀ t + ∬a dt,
/// otherwise a polynomial of fourth degree over half a period of the highest trusted frequency.
std::optional<StartMotion> findStartMotion(const RunMotion& run, const MountModel& model, const Drive& drive);

/// A state of the model in that motion: the mobile part as measured; bracket modes, if they are free, of least norm (in
/// ω η and η') among those that give the fixed part's pose and velocity; branches relaxed at rest, bristles
/// unstretched.
ForwardState makeState(const ForwardModel& forward, const StartMotion& start, const Drive& drive);

/// The start of a simulation: that of makeState, or rest.
ForwardState makeInitialState(const ForwardModel& forward, const std::optional<StartMotion>& start, const Drive& drive);

}  // namespace wems::identify
