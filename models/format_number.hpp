/// @file
/// Numbers as text.
#pragma once

#include <string>

namespace wems {

/// The shortest decimal that reads back as the same double; `nan`, `inf`, `-inf`.
std::string formatNumber(double value);
/// With so many significant digits, for messages.
std::string formatNumber(double value, int digits);

}  // namespace wems
