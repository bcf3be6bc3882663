/// @file
/// A recording against the model's connections: names that do not match, markers that are exchanged.
///
/// Both parts are rigid, so the 3 n channels u of one kind (displacements, velocities or accelerations) of a part with
/// n connections lie, but for noise and terms of second order in the rotation, in the range of u_i = p + θ × r_i, of
/// dimension six. What is outside it is the misfit. Two markers are called exchanged where the misfit of the recording
/// falls to a third or less when their channels trade places.
#pragma once

#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"
#include "models/recording/recording_checks.hpp"

namespace wems {

/// Findings of kind missing_connection (in the model, without channels), unknown_connection (channels of a connection
/// that the model does not have) and swapped. None is an error here.
std::vector<Finding> checkAgainstModel(const Recording& recording, const MountModel& model);

}  // namespace wems
