/// @file
/// Identified values as a model may hold them.
#pragma once

#include <string>
#include <vector>

#include "models/mount_model.hpp"

namespace wems {

/// Sets what a fit put below zero where a model allows no such value (stiffness, damping, loss factor, dissipation of
/// a stop, level of friction) to zero: as an estimate it says that the data do not show the thing, as a model it would
/// feed the motion with energy, and readMountModel() refuses it.
/// @returns one sentence for each value that was set
std::vector<std::string> makeAdmissible(MountModel& model);

}  // namespace wems
