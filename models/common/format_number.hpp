/// @file
/// Numbers and lists as text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace wems {

// The three axes of a frame by name.

inline constexpr const char* kAxes[3] = {"x", "y", "z"};

/// The shortest decimal that reads back as the same double; `nan`, `inf`, `-inf`.
std::string formatNumber(double value);
/// With so many significant digits, for messages.
std::string formatNumber(double value, int digits);
/// `a, b, c`
std::string joinWords(const std::vector<std::string>& words, const std::string& separator = ", ");
/// Without the characters of `outer` at its ends.
std::string_view trim(std::string_view text, std::string_view outer = " \t\r");
/// The cells of a line, each trimmed; empty ones too.
std::vector<std::string_view> splitCells(std::string_view line, char separator, std::string_view outer = " \t\r");

}  // namespace wems
