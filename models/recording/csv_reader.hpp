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
#include <vector>

#include "models/recording/column_map.hpp"
#include "models/recording/csv_body.hpp"
#include "models/recording/csv_layout.hpp"
#include "models/recording/recording.hpp"

namespace wems {

/// readRecording() of CSV text in memory; `file` stands in messages.
Recording parseRecording(std::string_view text, const std::string& file, const ColumnMap* map = nullptr);

/// A CSV file as far as its header tells.
struct CsvPlan {
    CsvLayout layout;                ///< its body is the text after the header
    Recording recording;             ///< names and units
    std::vector<CsvColumn> columns;  ///< time and channels, in the file's order
};

/// @throws InputError: no header, no channel, no time, a unit that is unknown or missing
CsvPlan planCsv(std::string_view text, const std::string& file, const ColumnMap* map);

/// Parses the rows of `plan.layout.body`, the first of which is row `first_row` of the file, and appends them to
/// `recording`, which has the plan's channels. Returns their number.
/// @throws InputError as readCsvBody(); a row without time, a value that is too large
std::size_t appendRows(CsvPlan& plan, Recording& recording);

}  // namespace wems
