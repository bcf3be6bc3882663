/// @file
/// What channels make of the truth, as the model's sensors say it; and a recording without that.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems {

/// Whether the sensor `group` names this channel: itself (`mobile.1.az`), all of a place (`mobile.1`), one kind of
/// channel there (`mobile.1.d` displacements, `mobile.1.v` velocities, `mobile.1.a` accelerations), or all of a part
/// (`mobile`, `load`).
bool concernsChannel(const std::string& group, const std::string& channel);

/// measured(t) = gain · (R_TS · true(t − delay))[axis of the channel] + zero.
struct SensorReading {
    double gain = 1;
    double delay = 0;                                    ///< s
    Eigen::Matrix3d R_TS = Eigen::Matrix3d::Identity();  ///< from the true axes to those that are measured
    double zero = 0;                                     ///< SI unit of the channel
};

/// Of one channel, with all faults that concern it: gains multiply, delays and zeros add, and the first rotation of the
/// list turns the truth first.
SensorReading readingOf(const std::vector<SensorFault>& faults, const std::string& channel);

/// The recording as it would be without the faults. Delays by cubic interpolation; samples beyond the ends are held.
/// A rotation is taken back where all three axes were recorded.
Recording correctChannels(const Recording& recording, const std::vector<SensorFault>& faults);

}  // namespace wems
