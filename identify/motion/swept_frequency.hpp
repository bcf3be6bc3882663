/// @file
/// The frequency at which a recording is driven, at each sample.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "models/recording/recording.hpp"

namespace wems::identify {

struct SweptFrequency {
    Eigen::VectorXd hertz;      ///< at each sample; NaN everywhere unless the drive is a sine
    bool is_sine = false;       ///< one frequency at a time (sweep, dwell), not random
    std::vector<double> tones;  ///< Hz, of several sines at once (findTones); otherwise empty
    double lowest = 0;          ///< Hz, lowest excited frequency; 0 if there is no drive
    double highest = 0;         ///< Hz
    std::string source;         ///< `load`, `base`, `fixed part` or `mobile part`
};

/// From the zero crossings of the strongest direction of the load; without load of the base's acceleration, then of the
/// fixed part's and the mobile part's accelerations, velocities or displacements. Periods are smoothed by a robust
/// local line in log frequency over ±5 periods. Several sines at once may cross zero as evenly as one does: they are
/// told by their spectrum. For them and for a random drive only lowest and highest are found (where the spectrum
/// exceeds 1 % of its maximum; of a motion 0.1 % of the velocity's).
SweptFrequency findSweptFrequency(const Recording& recording);

}  // namespace wems::identify
