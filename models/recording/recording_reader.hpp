/// @file
/// Recordings from files of any format that is read; the folder's README describes each.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "models/recording/column_map.hpp"
#include "models/recording/recording.hpp"
#include "models/recording/recording_stream.hpp"
#include "models/recording/recording_table.hpp"

namespace wems {

// The text formats other than CSV, each told once: what a file is, how it is read, and what the name of a file
// promises follow from this table.

struct TextFormat {
    /// True if a text begins as a file of this format does.
    bool (*recognises)(std::string_view text);
    /// @throws InputError with file and line
    RecordingTable (*read)(std::string_view text, const std::string& file);
    /// The same row by row, for recordings longer than memory.
    std::unique_ptr<RowSource> (*open)(const std::string& file, const ColumnMap* map);
    std::vector<std::string> extensions;  ///< that promise this format, in lower case; may be none
    const char* beginning;                ///< how a file begins, for the message about one that does not
};

/// In the order in which they are tried.
const std::vector<TextFormat>& textFormats();

/// The format that a text begins as; nullptr if it is none of them.
const TextFormat* findTextFormat(std::string_view text);

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
