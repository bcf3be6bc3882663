/// @file
/// Recordings from files of any format that is read: CSV, MATLAB 5 and 7.3 (HDF5), universal file 58, OpenSim .trc,
/// .sto, .mot.
#pragma once

#include <string>

#include "models/recording/column_map.hpp"
#include "models/recording/recording.hpp"

namespace wems {

/// Finds the format from the content, converts to SI, checks and repairs (recording_checks.hpp); every value of the
/// result is finite and time strictly increases. What was found odd or repaired stands in `warnings`.
/// @param map the laboratory's own column names, may be null
/// @throws InputError with file, row and column name.
Recording readRecording(const std::string& file, const ColumnMap* map = nullptr);

/// True if `file` is a CSV file on disk that RecordingStream reads: any but UTF-16. Never throws; what is wrong with a
/// file is readRecording()'s to say.
bool isPlainCsv(const std::string& file);

}  // namespace wems
