/// @file
/// Faulty channels (displacements, or accelerations where there are no displacements), from the consistency of a rigid
/// part alone: no force law enters.
///
/// With m channels of a rigid part and P the projector on what no rigid motion can make, the rigid fit leaves
/// e = P (noise + Σ faults). A fault acts linearly, for small ones, on the signals s of the rigid motion and their
/// rates: gain (g − 1) s_c, delay −τ s_c', misalignment of a triax r × s_i. Each hypothesis is tested against e with
/// the ordinary calibration scatter of all channels marginalised; the best is corrected exactly and the search goes on.
#pragma once

#include <string>
#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

/// A fault with the standard errors of its numbers.
struct ChannelFault {
    std::string cause;  ///< `sensor_gain`, `sensor_delay` or `sensor_misalignment`
    SensorFault fault;
    double gain_error = 0, delay_error = 0;  ///< -, s
    double rotation_error = 0;               ///< rad
    double improvement = 0;                  ///< misfit of the channels over noise before, over that after
};

/// Faults of single channels and triaxes of both sides, from all recordings together.
/// @param gain_scatter standard deviation of an ordinary channel's gain
std::vector<ChannelFault> findChannelFaults(const std::vector<Recording>& recordings, const MountModel& model,
                                            double gain_scatter);

}  // namespace wems::identify
