/// @file
/// Identified values as a model may hold them.
#pragma once

#include <string>
#include <vector>

#include "models/mount_model.hpp"

namespace wems {

/// Brings what a fit put outside what a model allows back to its limit, since readMountModel() refuses what lies
/// beyond. Values below zero where there are none (stiffness, damping, loss factor, dissipation of a stop, level of
/// friction) become zero: as an estimate they say that the data do not show the thing, as a model they would feed the
/// motion with energy. An inertia that no body has is limited as limitInertia() says.
/// @param believed model that the fit began with, itself admissible
/// @returns one sentence for each value that was changed
std::vector<std::string> makeAdmissible(const MountModel& believed, MountModel& model);

}  // namespace wems
