/// @file
/// What a recording's low pass took from the motion, as the model itself gives it.
///
/// A stop bends the acceleration, so that the displacement falls with 1 / f⁴ from there on and goes beyond any low
/// pass. A law that acts on the low-passed displacement misses its stop by that much: forces of a nonlinear law do not
/// commute with a filter. Beyond the band the motion is known all the same, since inertia rules it:
///
///     q(ω) = q_recorded(ω) + (1 − H(ω)) Dᵀ [M⁻¹ / ω² − R(ω)] D f(q)(ω)
///
/// with H the low pass, D the directions of the axes, M the mass matrix, R the bracket's receptance and f the laws'
/// forces. Picard iteration finds it, which contracts by (1 − H) (f_c / f)² with f_c the frequency of contact
/// (calcContactFrequency). What of it lies beyond half the recording's rate has folded into its displacements, and is
/// taken off there; where accelerations decide the motion it is left (fourier.hpp, calcAliasing).
#pragma once

#include "identify/problem/open_loop_run.hpp"

namespace wems::identify {

/// Whether any axis does.
bool reachesStops(const OpenLoopRun& run, const MountModel& model);

/// In a run whose samples are closer than those of its recording (RunFilter::refines); others are left alone. The
/// relative motion has it, that of both parts does not: their equations are those of the low-passed motion.
OpenLoopRun restoreFastMotion(OpenLoopRun run, const MountModel& model);

}  // namespace wems::identify
