/// @file
/// Uniform sampling: what filters and differences need, from stamps as recorders write them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "models/recording/recording.hpp"

namespace wems::identify {

/// `recording` on uniform stamps with the mean interval. Stamps that are uniform but for the rounding of their decimals
/// only get their rounding removed. Of others it is asked whether the samples are as irregular as their stamps: a
/// clock that samples evenly may be read late, and then the stamps alone jitter. Where the samples follow a smooth
/// course better at even instants, they are taken at those; else they are interpolated by local cubic polynomials, with
/// the largest gap bridged. `notes` says which.
/// @throws InputError with fewer than eight samples.
Recording makeUniform(const Recording& recording, std::vector<std::string>& notes);

/// Value at `t` of the cubic through the four samples around it; `time` ascending, at least four samples.
double interpolateCubic(const std::vector<double>& time, const std::vector<double>& values, std::size_t interval,
                        double t);

}  // namespace wems::identify
