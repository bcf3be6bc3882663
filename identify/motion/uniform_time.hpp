/// @file
/// Uniform sampling: what filters and differences need.
#pragma once

#include <string>
#include <vector>

#include "models/recording/recording.hpp"

namespace wems::identify {

/// `recording` on uniform stamps with the mean interval. Stamps that are uniform but for the rounding of their decimals
/// only get their rounding removed; others are interpolated by local cubic polynomials, which `notes` says, with the
/// largest gap bridged.
/// @throws InputError with fewer than eight samples.
Recording makeUniform(const Recording& recording, std::vector<std::string>& notes);

/// Value at `t` of the cubic through the four samples around it; `time` ascending, at least four samples.
double interpolateCubic(const std::vector<double>& time, const std::vector<double>& values, std::size_t interval,
                        double t);

}  // namespace wems::identify
