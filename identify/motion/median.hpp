/// @file
/// Robust location: the middle value.
#pragma once

#include <vector>

namespace wems::identify {

/// The upper middle of `values` (not empty; taken by value because it is partly sorted).
double median(std::vector<double> values);

}  // namespace wems::identify
