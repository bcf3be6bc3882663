/// @file
/// Gross faults of a measurement, several at once: wrong units and signs, exchanged channels, delays, clocks that
/// drift apart.
///
/// In a cell of time and frequency (channel_cells.hpp) channel c holds
///
///     X_c = g_c exp(−iω (τ_c + ε_c t)) d_π(c) · m
///
/// with gain g, delay τ, clock drift ε and the exchange π of rows; all is 1, 0, 0 and the identity in a measurement
/// without faults. For any set of faults the motions m follow by least squares, and what is left over, compared with
/// what small errors of sensors leave (a floor relative to the signals), is the misfit. The smallest set of faults
/// whose misfit is that of small errors is what is named. Sets grow one fault at a time; the best few are kept at each
/// size.
#pragma once

#include <string>
#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

struct MeasurementFault {
    enum class Kind { unit, gain, sign, exchanged, delay, clock_drift };
    Kind kind = Kind::gain;
    std::string channel;         ///< `mobile.1.az`; of all of a sensor `mobile.1`, of a kind `mobile.*.ax|ay|az`
    std::string exchanged_with;  ///< with kind exchanged
    double factor = 1;           ///< recorded over true: unit, gain, sign
    double delay = 0;            ///< s, at the middle of the recording: delay, clock_drift
    double drift = 0;            ///< s/s: clock_drift
    std::vector<std::string> alternatives;  ///< other faults that explain as much in its place, as describe() has them
};

/// `unit`, `gain`, `sign` … as results have them.
const char* kindName(MeasurementFault::Kind kind);
/// One sentence without a full stop.
std::string describe(const MeasurementFault& fault);

struct PartConsistency {
    Part part = Part::mobile;
    int redundancy = 0;  ///< channels beyond the motions that they determine; 0: nothing can be checked
    double before = 0;   ///< misfit, of the signals, as recorded
    double after = 0;    ///< with the faults taken off
    bool solved = true;  ///< false: the channels contradict each other, and no few faults explain it
    std::vector<MeasurementFault> faults;
};

/// @param recording uniformly sampled
/// @returns one entry for each part that has channels and is long enough
std::vector<PartConsistency> findMeasurementFaults(const Recording& recording, const MountModel& model);

}  // namespace wems::identify
