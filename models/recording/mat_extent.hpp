/// @file
/// Whether what a MATLAB file says of its own sizes can be true.
#pragma once

#include <string>
#include <string_view>

namespace wems {

/// Walks through the elements of a file of version 4 or 5 without reading their values: each must lie within the one
/// around it, and an array must not have more elements than bytes. matio believes such numbers and takes gigabytes of
/// memory for a damaged file of a few kilobytes. Compressed variables are inflated for that, one at a time.
///
/// Source: MathWorks, MAT-File Format (R2023a), chapters 1 (version 5) and 2 (version 4).
///
/// @throws InputError: damaged, at which byte
void checkMatExtent(std::string_view content, const std::string& file);

}  // namespace wems
