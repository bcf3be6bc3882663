/// @file
/// Motion of a guided part (`[body] motion`) from its channels: the free coordinates alone, relative to a reference
/// that is known.
#pragma once

#include "identify/motion/part_motion.hpp"

namespace wems::identify {

/// As estimatePart, for the free coordinates s of models/guided_motion.hpp: s least squares from the displacements at
/// each sample on its own, s'' from the accelerations with the reference's and the Coriolis terms; then fused,
/// differentiated or integrated coordinate by coordinate and composed with the reference.
/// @param reference motion of the frame that the held motions are fixed to: the fixed part, or standstill
/// @throws InputError if neither displacements nor accelerations determine the free motions, naming those left open.
PartEstimate estimateGuided(const Recording& recording, const MountModel& model, Part part, const BodyMotion& rest,
                            const PartMotion& reference, ContactEdges edges = ContactEdges::sampled);

/// True if displacement, velocity or acceleration channels of this part determine the free motions.
bool determinesGuided(const Recording& recording, const MountModel& model, Part part, const BodyMotion& rest);

}  // namespace wems::identify
