/// @file
/// Dry friction along a sampled motion. At a reversal F tanh(v/v_t) jumps within v_t/a, far less than a sampling
/// interval: its values at the samples would depend on where the reversal falls between them, an error in time of up to
/// half an interval, which spreads over all frequencies.
#pragma once

#include <Eigen/Core>

namespace wems::identify {

/// tanh(v/v_t) at the samples as a band-limited signal: its mean over the interval around each sample, with v linear
/// between samples, corrected to second order for what the mean takes from it.
/// @param v velocity at samples, m/s
/// @param transition_velocity v_t, m/s
Eigen::VectorXd calcSlidingDirection(const Eigen::VectorXd& v, double transition_velocity);

}  // namespace wems::identify
