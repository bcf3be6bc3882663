// C++17 has no std::numbers::pi.
#pragma once

namespace wems {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kTwoPi = 2 * kPi;

}  // namespace wems
