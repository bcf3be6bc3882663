/// @file
/// Numbers and lists as text.
#pragma once

#include <string>
#include <vector>

namespace wems {

/// The shortest decimal that reads back as the same double; `nan`, `inf`, `-inf`.
std::string formatNumber(double value);
/// With so many significant digits, for messages.
std::string formatNumber(double value, int digits);
/// `a, b, c`
std::string joinWords(const std::vector<std::string>& words, const std::string& separator = ", ");

}  // namespace wems
