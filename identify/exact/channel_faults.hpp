/// @file
/// Faulty channels (displacements, or accelerations where there are no displacements), from the consistency of a rigid
/// part alone: no force law enters.
///
/// With m channels of a rigid part and P the projector on what no rigid motion can make, the rigid fit leaves
/// e = P (noise + Σ faults). A fault acts linearly, for small ones, on the signals s of the rigid motion and their
/// rates: gain (g − 1) s_c, delay −τ s_c', misalignment of a triax r × s_i. Each hypothesis is tested against e with
/// the ordinary calibration scatter of all channels marginalised; the best is corrected exactly and the search goes on.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "models/common/units.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

// From where on a channel is called faulty: the same for markers and for accelerometers.

inline constexpr double kLeastFaultGain = 60.0;  // decrease of the misfit in units of its noise
inline constexpr double kScatters = 6.0;         // a gain fault is beyond this many scatters of calibration
inline constexpr double kLeastDelay = 2e-5;      // s
inline constexpr double kLeastRotation = 4e-3;   // rad
// rad, standard deviation of a triax' rotation before it is measured. Where the part moves along one axis alone,
// nothing tells how far a triax is turned about it: it then stays where it was.
inline constexpr double kTurned = 1.0;

/// By more than calibration leaves, and by less than half a turn: beyond it every direction has a nearer name.
inline bool isTurned(const Eigen::VectorXd& rotation) {
    return rotation.norm() > kLeastRotation && rotation.norm() < kPi;
}

// Undoing what a faulty sensor made of the truth: measured(t) = gain · R(rotation) · true(t − delay).

/// The recording as it would be without the faults. A fault names a channel (`mobile.1.az`), a triax (`mobile.1`, which
/// takes its displacements, or `mobile.1.a`, its accelerations) or a side (`mobile`, `fixed`): its displacements, or
/// its accelerations where no displacements were recorded. Delays by cubic interpolation; samples beyond the ends are
/// held.
Recording correctChannels(const Recording& recording, const std::vector<SensorFault>& faults);

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
