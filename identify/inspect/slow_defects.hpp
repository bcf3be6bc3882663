/// @file
/// What sits under a signal: offset, drift, hum of the mains.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/motion/swept_frequency.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

/// Level of a channel at the start, and its change over the recording, of means over blocks.
struct SlowLevel {
    double start = 0;            ///< SI
    double change = 0;           ///< SI, over the recording
    double start_deviation = 0;  ///< standard deviations of both
    double change_deviation = 0;
};

/// A line through the means of blocks (each ten of the slowest periods, at least forty blocks if the recording is long
/// enough), Theil–Sen: blocks in which a nonlinear device moves off centre do not matter while they are fewer than
/// 29 %.
SlowLevel findSlowLevel(const Eigen::VectorXd& signal, double interval, double lowest);

/// Findings of kind offset, drift and hum.
/// @param noise of the channel, SI
std::vector<Finding> findSlowDefects(const Channel& channel, double interval, double noise, const SweptFrequency& swept,
                                     const std::vector<double>& time, long row);

}  // namespace wems::identify
