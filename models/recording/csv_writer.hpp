/// @file
/// Recordings to CSV files.
#pragma once

#include <string>

#include "models/recording/recording.hpp"

namespace wems {

/// Writes metadata lines, a header row and the samples: comma, decimal point, LF. Values are written in the channel's
/// unit (SI if it has none) with `digits` significant digits, time in s with at least 12; NaN becomes an empty field.
/// The file is complete or not there. It reads back to the same numbers to the digits printed.
/// @param digits 1 to 17
/// @throws InputError: the file cannot be written, or a channel's unit is not known.
/// @throws std::invalid_argument: a channel whose length is not that of time, a name that is no channel, a value that
///         is infinite.
void writeCsv(const Recording& recording, const std::string& file, int digits = 9);

}  // namespace wems
