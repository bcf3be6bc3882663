/// @file
/// The same device slowed or sped: all times are multiplied by a factor, lengths and masses stay, so that forces and
/// accelerations are divided by its square.
#pragma once

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::hidden {

MountModel slowDown(const MountModel& model, double factor);
/// @param recording of the device in unit time; gets its times and units
Recording slowDown(Recording recording, double factor);

}  // namespace wems::hidden
