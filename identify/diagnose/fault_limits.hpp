// From where on a channel is called faulty: the same for markers and for accelerometers.
#pragma once

#include <Eigen/Core>

#include "models/pi.hpp"

namespace wems::identify {

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

}  // namespace wems::identify
