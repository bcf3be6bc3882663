// From where on a channel is called faulty: the same for markers and for accelerometers.
#pragma once

namespace wems::identify {

inline constexpr double kLeastFaultGain = 60.0;  // decrease of the misfit in units of its noise
inline constexpr double kScatters = 6.0;         // a gain fault is beyond this many scatters of calibration
inline constexpr double kLeastDelay = 2e-5;      // s
inline constexpr double kLeastRotation = 4e-3;   // rad

}  // namespace wems::identify
