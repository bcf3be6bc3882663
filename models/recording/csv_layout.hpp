/// @file
/// What stands before the numbers in a CSV file: free text, metadata lines, separator, decimal sign, header, units.
///
/// The header is the row among the first 200 in which most fields are known: a channel's name, `time`, or a name of the
/// column map. Rows before it are free text; `key: value`, with or without `#`, and rows of two fields become metadata.
/// Rows without any number between the header and the data hold units, if they do, or are skipped with a warning.
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
    std::vector<std::string> units;    ///< of a unit row, without brackets; empty if there is none
    long header_row = 0;               ///< from 1
    long first_row = 0;                ///< of the data, from 1
    std::string_view body;             ///< the data rows, first_row on
    std::vector<std::string> warnings;
};

/// @param map shape given by the user, may be null
/// @throws InputError: binary content, no header row, no data rows, a quote that is not closed.
CsvLayout readCsvLayout(std::string_view text, const std::string& file, const ColumnMap* map);

/// Fields of one row without line end; quotes are taken off, a doubled quote inside becomes one. False if a quote is
/// not closed.
bool splitCsvRow(std::string_view row, char separator, std::vector<std::string>& fields);

/// True if there is nothing but separators, spaces, tabs and line ends.
bool isBlankCsv(std::string_view text, char separator);

/// `text` without spaces, tabs and a carriage return at its ends.
std::string_view trimCsvField(std::string_view text);

}  // namespace wems
