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

/// Displacements that no motion of a rigid part makes: with u_i = p + (R − 1) r_i the difference of two points'
/// displacements is (R − 1)(r_i − r_j), which between two instants changes by at most 2 |r_i − r_j|, whatever the
/// motion and the rest.
/// @throws InputError with the row where a channel has left the first one of its part and axis by more than twice the
/// largest distance between two connections
void checkRigidBound(const Recording& recording, const MountModel& model);

}  // namespace wems
