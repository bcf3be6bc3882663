// The three axes of a frame by name.
#pragma once

namespace wems {

inline constexpr const char* kAxes[3] = {"x", "y", "z"};

}  // namespace wems
