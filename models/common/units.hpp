/// @file
/// Units that files may use, and their factors to SI.
#pragma once

#include <string>
#include <string_view>

#include "models/common/error.hpp"

namespace wems {

// C++17 has no std::numbers::pi.

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kTwoPi = 2 * kPi;

/// Physical quantity of a column. `none` has no unit, written `-` or nothing.
enum class Quantity { time, length, velocity, acceleration, force, none };

/// Factor with value_SI = factor · value. Spaces around `unit` do not matter; micro may be written u, µ (U+00B5) or
/// μ (U+03BC), a square ^2 or ².
/// @throws InputError at `location` listing the units accepted for `quantity`.
double findUnitFactor(std::string_view unit, Quantity quantity, const InputLocation& location);

/// True if `unit` is a unit of any quantity that is read.
bool isUnit(std::string_view unit);

/// The units accepted for `quantity`, as they stand in messages: `m, mm, um, in`.
std::string listUnits(Quantity quantity);

/// The SI unit, `m/s^2`; `-` for none.
const char* siUnit(Quantity quantity);

}  // namespace wems
