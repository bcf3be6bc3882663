/// @file
/// Recordings from CSV text.
///
/// Free text and lines `# key: value` (optional), one header row, units below it if the header has none, one row for
/// each sample. A column is `name [unit]`; the time column is `time`. Comma, semicolon or tab; decimal point or comma;
/// UTF-8 with or without byte-order mark, UTF-16 with one, LF or CRLF; quoted fields; separators at the end of rows and
/// blank rows at the end of the file do not matter.
#pragma once

#include <string>
#include <string_view>

#include "models/recording/column_map.hpp"
#include "models/recording/recording.hpp"

namespace wems {

/// readRecording() of CSV text in memory; `file` stands in messages.
Recording parseRecording(std::string_view text, const std::string& file, const ColumnMap* map = nullptr);

}  // namespace wems
