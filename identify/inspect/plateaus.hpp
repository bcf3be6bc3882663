/// @file
/// Where a channel stands still although its signal moves: saturated sensors and drop-outs.
#pragma once

#include <vector>

#include "models/recording/recording.hpp"

namespace wems::identify {

/// Findings of kind saturated and drop_out in one channel.
///
/// - Saturated: two runs or more of six samples or more within 7 noise deviations σ of the channel's largest (smallest)
///   value, entered and left by steps above 8 σ a sample. A smooth peak of curvature c (a sample squared) stays n
///   samples in such a band, n² = 56 σ/c, and leaves it by c n/2 = 28 σ/n: below 4.7 σ for n of 6 or more. Or: at least
///   30 samples in that band, in five separate excursions, and eight times as many as in each of the three bands beside
///   it on average; a sine of constant amplitude has three times as many. That band is at least four steps wide of the
///   values as they are written; where four of it do not fit between the largest value and the median, as above a
///   single high peak, there is no limit to see. Exact plateaus are the business of checkChannels() (clipped).
/// - Drop-out: the channel repeats one value, not its largest or smallest, for five samples or more and jumps off or
///   onto it by more than four steps of its resolution and 6 σ, in the midst of motion. Where that is so in a tenth of
///   all samples the channel holds each value for a while, because it was sampled more slowly than the others.
///
/// @param noise σ of the channel, in its SI unit
/// @param row row of the file of the first sample
std::vector<Finding> findPlateaus(const Channel& channel, const std::vector<double>& time, double noise, long row);

}  // namespace wems::identify
