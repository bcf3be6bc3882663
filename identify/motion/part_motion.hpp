/// @file
/// Motion of one part from its channels: chooses between fusion, differentiation and integration.
#pragma once

#include <string>
#include <vector>

#include "identify/motion/motion.hpp"
#include "models/mount_forces.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

struct PartEstimate {
    PartMotion motion;
    double trusted_from = 0;         ///< Hz
    double trusted_to = 0;           ///< Hz
    std::vector<std::string> notes;  ///< begin with the part's name
};

/// @param recording uniformly sampled
/// @param part mobile or fixed, with at least one channel
/// @param rest pose at the static equilibrium, from which displacements count
/// @throws InputError if neither displacements nor accelerations determine all six motions, naming those left open.
PartEstimate estimatePart(const Recording& recording, const MountModel& model, Part part, const BodyMotion& rest,
                          ContactEdges edges = ContactEdges::sampled);

/// True if displacement, velocity or acceleration channels of this part determine all six motions.
bool determinesPart(const Recording& recording, const MountModel& model, Part part, const BodyMotion& rest);

/// A part that translates with a measured acceleration (base motion).
PartEstimate estimateTranslation(const Recording& recording, const Eigen::Matrix3Xd& acceleration,
                                 const BodyMotion& rest);

/// A part that stays at `rest`.
PartMotion makeStandstill(const BodyMotion& rest, Eigen::Index samples);

/// Pose of the fixed part at the static equilibrium.
BodyMotion findFixedRest(const MountModel& model, const StaticEquilibrium& equilibrium);

/// True if `recording` has displacement, velocity or acceleration channels of this part.
bool hasChannels(const Recording& recording, Part part);

}  // namespace wems::identify
