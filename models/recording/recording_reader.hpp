/// @file
/// Recordings from files of any format that is read; the folder's README describes each.
#pragma once

#include <string>

#include "models/recording/column_map.hpp"
#include "models/recording/recording.hpp"

namespace wems {

/// For the helps of commands.
inline constexpr const char* kReadableFormats = "CSV, MATLAB, UFF 58, OpenSim, LabVIEW .lvm, JSON";

/// Finds the format from the content, converts to SI, checks and repairs (recording_checks.hpp); every value of the
/// result is finite and time strictly increases. What was found odd or repaired stands in `warnings`.
/// @param map the laboratory's own column names, may be null
/// @throws InputError with file, row and column name.
Recording readRecording(const std::string& file, const ColumnMap* map = nullptr);

/// True if `file` is a file on disk that RecordingStream reads: CSV (but UTF-16), universal file 58, OpenSim's,
/// LabVIEW's .lvm, MATLAB 7.3 and other HDF5 files. Never throws; what is wrong with a file is readRecording()'s to
/// say.
bool isStreamable(const std::string& file);

}  // namespace wems
