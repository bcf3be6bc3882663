/// @file
/// Where the mobile part rests under gravity, and how much of each clearance is left there.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "models/mount_model.hpp"

namespace wems {

/// `4.z.+`, and the way to it from rest.
struct StopMargin {
    int connection = 0, axis = 0;
    std::size_t stop = 0;  ///< index in the axis law
    double clearance = 0;  ///< m, from the middle of the gap
    double left = 0;       ///< m, from rest to contact; negative: pressed by so much
};
std::string nameStop(const MountModel& model, const StopMargin& margin);

struct StaticSag {
    Eigen::Vector3d displacement;   ///< m, of the mobile part's centre of gravity, from the unloaded position, G axes
    Eigen::Vector3d rotation;       ///< rad, rotation vector of the mobile part, G axes
    Eigen::Matrix3Xd relative;      ///< m, q of each connection, F axes
    Eigen::Matrix3Xd force;         ///< N, that each connection carries, F axes, sign of q
    std::vector<StopMargin> stops;  ///< in the order of the model
};

/// @throws InputError if the model has no static equilibrium.
StaticSag findStaticSag(const MountModel& model);

}  // namespace wems
