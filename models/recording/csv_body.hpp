/// @file
/// The numbers of a CSV file, parsed into columns.
#pragma once

#include <string>
#include <vector>

#include "models/recording/csv_layout.hpp"

namespace wems {

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

}  // namespace wems
