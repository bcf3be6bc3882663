/// @file
/// Recordings from CSV files.
///
/// First lines `# key: value` (optional), one header row, one row for each sample. A column is `name [unit]`; the time
/// column is `time`. Comma, semicolon or tab; decimal point or comma; UTF-8 with or without byte-order mark, LF or
/// CRLF; quoted fields; separators at the end of rows and blank rows at the end of the file do not matter.
#pragma once

#include <string>
#include <string_view>

#include "models/recording/column_map.hpp"
#include "models/recording/recording.hpp"

namespace wems {

/// Reads, converts to SI, checks and repairs (recording_checks.hpp); every value of the result is finite and time
/// strictly increases. What was found odd or repaired stands in `warnings`.
/// @param map the laboratory's own column names, may be null
/// @throws InputError with file, row and column name.
Recording readRecording(const std::string& file, const ColumnMap* map = nullptr);

/// The same from text in memory; `file` stands in messages.
Recording parseRecording(std::string_view text, const std::string& file, const ColumnMap* map = nullptr);

}  // namespace wems
