/// @file
/// Recordings from CSV text.
///
/// Free text and lines `# key: value` (optional), one header row, units below it if the header has none, one row for
/// each sample. A column is `name [unit]`; the time column is `time`. Comma, semicolon or tab; decimal point or comma;
/// UTF-8 with or without byte-order mark, UTF-16 with one, LF or CRLF; quoted fields; separators at the end of rows and
/// blank rows at the end of the file do not matter.
#pragma once

#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "models/recording/column_map.hpp"
#include "models/recording/csv_layout.hpp"
#include "models/recording/recording.hpp"
#include "models/recording/recording_stream.hpp"

namespace wems {

// The numbers of a CSV file, parsed into columns.

/// A column to read; others are skipped unparsed, but counted.
struct CsvColumn {
    int index = 0;     ///< from 0, in the file
    std::string name;  ///< for messages
    double scale = 1;  ///< value in SI = scale · number + offset
    double offset = 0;
    std::vector<double> values;  ///< result; NaN where the field is empty or says nan
    bool has_non_finite = false;
};

/// Fills the values of `columns` (ascending indices). Blank rows, or rows of separators only, may stand at the end;
/// empty fields may follow the last column of a row.
/// @throws InputError with row and column: not a number, infinite, a row of fewer or more fields than the header, a
///         blank row inside the data, no data rows.
void readCsvBody(const CsvLayout& layout, const std::string& file, std::vector<CsvColumn>& columns);

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

// Rows of a CSV file.

/// Reads a few megabytes of text at a time.
class CsvRows : public RowSource {
public:
    CsvRows(const std::string& file, const ColumnMap* map);

    const Recording& header() const override { return plan_.recording; }
    double expectedSamples() const override { return expected_samples_; }
    bool append(Recording& rows) override;

private:
    std::string_view readText();
    void parse(Recording& rows);

    std::string file_;
    std::ifstream input_;
    std::string text_;             // read and not yet parsed
    std::size_t parsed_text_ = 0;  // bytes of text_ that were
    CsvPlan plan_;
    double expected_samples_ = 0;
    bool is_first_ = true;    // the rows that came with the header are still to be parsed
    bool at_end_ = false;     // of the file
    bool past_rows_ = false;  // a blank row was read: no more may follow
};

}  // namespace wems
