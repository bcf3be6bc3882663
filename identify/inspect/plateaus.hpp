/// @file
/// Where a channel stands still although its signal moves: saturated sensors and drop-outs.
#pragma once

#include <vector>

#include "models/recording/recording.hpp"

namespace wems::identify {

/// Findings of kind saturated and drop_out in one channel.
///
/// - Saturated: runs of six samples or more within ±3 noise deviations σ of the channel's largest or smallest value,
///   entered or left by a step above 6 σ a sample. A smooth peak of curvature c (a sample squared) stays n samples in a
///   band of 6 σ, n² = 48 σ/c, and leaves it by c n/2 = 12 σ · 2/n: above 6 σ only for n below 4. Exact plateaus are
///   the business of checkChannels() (clipped).
/// - Drop-out: the channel repeats one value, not its largest or smallest, for four samples or more where it moves by
///   more than its resolution just before or after.
///
/// @param noise σ of the channel, in its SI unit
/// @param row row of the file of the first sample
std::vector<Finding> findPlateaus(const Channel& channel, const std::vector<double>& time, double noise, long row);

}  // namespace wems::identify
