/// @file
/// Strokes between the reversals of a motion, and what dry friction and backlash leave in them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/sampled_motion.hpp"

namespace wems::identify {

/// Direction of travel at every sample, +1 or −1: that of the stroke it belongs to.
Eigen::VectorXd calcDirection(const Eigen::VectorXd& q, double fraction);

/// Travel since the last reversal at every sample, m; NaN before the first.
Eigen::VectorXd calcTravel(const Eigen::VectorXd& q, double fraction);

/// True at the samples of full strokes: between two reversals, at least 80 % as long as the longest such stroke.
std::vector<bool> findFullStrokes(const Eigen::VectorXd& q);

/// A median over strokes with its 95 % interval; the strokes are the independent repeats, so that whatever the samples
/// within a stroke have in common is in the interval.
struct StrokeStatistic {
    double value = 0;
    double lower = 0, upper = 0;  ///< infinite with fewer than two strokes
    std::vector<double> strokes;  ///< one value for each
};
StrokeStatistic summariseStrokes(std::vector<double> values);

/// What a dry-friction element with backlash shows.
struct StrokeSummary {
    StrokeStatistic positive_level;                          ///< N, force while sliding towards +q
    StrokeStatistic negative_level;                          ///< N, towards −q (negative)
    StrokeStatistic gap;                                     ///< m, all reversals
    StrokeStatistic gap_after_positive, gap_after_negative;  ///< m, after a stroke towards + or −
    double low_force = 0;                                    ///< N, |f| below this counts as gap
    double rise = 0;       ///< m, median travel from 1 to 3 low forces or back, on either side of the gap
    double stroke = 0;     ///< m, mean travel between reversals
    double loop_fill = 0;  ///< energy of a loop over that of the rectangle of its levels and stroke
    double flatness = 0;   ///< change of force over the second half of a stroke over the mean level
};

/// Levels: median force over the second half of each full stroke. Gap: travel between the
/// first and the last sample of a stroke with |f| below `low_force` (0: 5 % of the mean level).
StrokeSummary summariseFriction(const Eigen::VectorXd& q, const Eigen::VectorXd& force, double low_force = 0);

}  // namespace wems::identify
