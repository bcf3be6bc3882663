/// @file
/// Hum of the mains: a line at 50 or 60 Hz that is there all the time at one phase.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <string>
#include <vector>

#include "identify/motion/swept_frequency.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

struct Hum {
    double frequency = 0;  ///< Hz; 0: there is none
    std::complex<double> amplitude =
        0;             ///< SI; the line is Re(amplitude exp(2πi frequency t)), t from the first sample
    double block = 0;  ///< s, of the stretches that show it
};

/// Components at 50 and 60 Hz (±0.1 Hz) of Hann blocks that overlap by half, an eighth of the recording and at most one
/// second long. What most blocks have in one phase convention tells hum from a sweep that passes by. Counts from six
/// standard deviations on.
Hum findHum(const Eigen::VectorXd& signal, double interval);

/// Whether the recording is driven at this frequency, by a dwell or by one of several sines.
bool isDrivenAt(const SweptFrequency& swept, double frequency, double duration);

/// Takes hum off what drives the device, channels of load and base: a table that does not move at 60 Hz would be
/// simulated as if it did. Each channel is named in `notes`.
void removeDriveHum(Recording& uniform, std::vector<std::string>& notes);

}  // namespace wems::identify
