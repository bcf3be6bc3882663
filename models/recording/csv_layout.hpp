/// @file
/// What stands before the numbers in a CSV file: metadata lines, separator, decimal sign, header row.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "models/recording/column_map.hpp"

namespace wems {

struct CsvLayout {
    std::map<std::string, std::string> metadata;  ///< the `# key: value` lines
    char separator = ',';
    char decimal = '.';
    bool has_quotes = false;           ///< in the data
    std::vector<std::string> headers;  ///< as in the file, without quotes and outer spaces
    long header_row = 0;               ///< from 1
    std::string_view body;             ///< the data rows, first_row() on
    long firstRow() const { return header_row + 1; }
};

/// @param map shape given by the user, may be null
/// @throws InputError: binary or UTF-16 content, no header row, no data rows, a quote that is not closed.
CsvLayout readCsvLayout(std::string_view text, const std::string& file, const ColumnMap* map);

/// Header `name [unit]`, or `name (unit)` where `parentheses` is set, taken apart.
struct CsvHeader {
    std::string name, unit;
    bool has_unit = false;
};
CsvHeader parseCsvHeader(const std::string& header, bool parentheses);

/// Fields of one row without line end; quotes are taken off, a doubled quote inside becomes one. False if a quote is
/// not closed.
bool splitCsvRow(std::string_view row, char separator, std::vector<std::string>& fields);

/// `text` without spaces, tabs and a carriage return at its ends.
std::string_view trimCsvField(std::string_view text);

}  // namespace wems
