/// @file
/// The noise of channels that have no redundancy, under a drive that fills its band at all times.
#pragma once

#include <Eigen/Core>

#include "identify/motion/noise_density.hpp"
#include "identify/problem/open_loop_run.hpp"

namespace wems::identify {

/// What stands beside the driven band: white noise as above it, where nothing is driven and an anti-alias filter lets
/// it through, and 1/f noise as below it,
///
///     S(f) = w + p / f.
///
/// Below the band there may be more than noise: a drive that fades out, a table that creeps, what a stop on one side
/// makes of a drive. None of it falls as 1/f, so that the octave in which f S(f) is least bounds p; so does what the
/// spectrum falls by above the band. White alone where no octave below the band is resolved.
///
/// Above the band a stop that is touched is heard, too, for moments. The lower quartile in time of short windows leaves
/// it out: ten contacts a second made the noise 30 times too large in windows of 1.3 s, in those of 0.1 s 1.3 times.
/// @param values channels x samples
/// @param count of those that are not zero, ≥ 1
/// @param resolution Hz, of the answer
/// @param least variance below which no noise lies (round-off of the file), unit²
NoiseDensity estimateNoiseBesideBand(const Eigen::MatrixXd& values, int count, const ExcitedBand& band, double interval,
                                     double resolution, double least);

}  // namespace wems::identify
