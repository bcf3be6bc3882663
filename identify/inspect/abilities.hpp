/// @file
/// What can be identified from a recording.
#pragma once

#include <string>
#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

/// Whether the relative displacements of the rigid motions pass each stop's clearance, connection by connection, axis
/// by axis; empty if the motions cannot be recovered.
std::vector<bool> findReachedStops(const Recording& recording, const MountModel& model);

/// One sentence for each thing that can or cannot be told; the drive, the motion of each part (with a model: which of
/// the six motions its channels leave open), component tests, stops that are reached.
/// @param recording its channels' names count
/// @param model may be null
/// @param reached findReachedStops(); not looked at without a model
std::vector<std::string> describeAbilities(const Recording& recording, const MountModel* model,
                                           const std::vector<bool>& reached);

}  // namespace wems::identify
