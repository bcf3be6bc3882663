/// @file
/// What can be identified from a recording.
#pragma once

#include <string>
#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

/// One sentence for each thing that can or cannot be told; the drive, the motion of each part (with a model: which of
/// the six motions its channels leave open), component tests, stops that are reached.
/// @param model may be null
std::vector<std::string> describeAbilities(const Recording& recording, const MountModel* model);

}  // namespace wems::identify
