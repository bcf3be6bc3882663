/// @file
/// Undoing what a faulty sensor made of the truth: measured(t) = gain · R(rotation) · true(t − delay) + zero.
#pragma once

#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

/// The recording as it would be without the faults. A fault names a channel (`mobile.1.az`), a triax (`mobile.1`, which
/// takes its displacements, or `mobile.1.a`, its accelerations) or a side (`mobile`, `fixed`): its displacements, or
/// its accelerations where no displacements were recorded. Delays by cubic interpolation; samples beyond the ends are
/// held.
Recording correctChannels(const Recording& recording, const std::vector<SensorFault>& faults);

}  // namespace wems::identify
