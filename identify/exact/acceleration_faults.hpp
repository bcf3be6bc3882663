/// @file
/// Faulty acceleration channels where displacements were recorded too: against the acceleration that the rigid motion
/// of the displacements implies at the same point.
#pragma once

#include <vector>

#include "identify/exact/channel_faults.hpp"
#include "identify/motion/motion.hpp"

namespace wems::identify {

/// @param recordings with their displacement channels already corrected
/// @param motions their rigid motions, from displacements
std::vector<ChannelFault> findAccelerationFaults(const std::vector<Recording>& recordings,
                                                 const std::vector<RunMotion>& motions, const MountModel& model,
                                                 double gain_scatter);

}  // namespace wems::identify
