/// @file
/// Where the recorded load acts.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "models/mount_forces.hpp"

namespace wems {

/// Adds the load (N, in G) to the wrench on the part that it acts on, if there is a load point of the model's own.
/// @param[in,out] on_mobile at M's origin, @param[in,out] on_fixed at F's origin, in G
/// @return the load that is left for the bracket's load point
Eigen::Vector3d applyLoad(const std::optional<LoadPoint>& point, const BodyMotion& mobile, const FrameMotion& fixed,
                          const Eigen::Vector3d& load, Wrench& on_mobile, Wrench& on_fixed);

/// True if a recorded load moves something: it acts on the mobile part, or there is a bracket.
bool loadActs(const MountModel& model);

}  // namespace wems
