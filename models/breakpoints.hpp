/// @file
/// Rows of test specifications: breakpoints over frequency, as tables in text.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "models/error.hpp"

namespace wems {

/// One row of a table in text: cells between commas, semicolons, tabs or blanks, whichever occurs first in this order.
struct TextRow {
    long line = 0;  ///< from 1
    std::string_view text;
    std::vector<std::string_view> cells;  ///< without blanks and quotes around them
};

/// Rows that are neither empty nor a comment, which `#` begins. The cells point into `text`.
std::vector<TextRow> splitTextRows(std::string_view text);

/// Frequencies (Hz, ascending) and what a specification demands there, straight lines in log–log between.
struct Breakpoints {
    std::vector<double> frequency, value;

    /// 0 outside.
    double calcValue(double at) const;
};

/// What the second column of a file of breakpoints is.
struct BreakpointColumn {
    const char* name;   ///< in messages
    const char* units;  ///< accepted, in messages
    /// Factor to SI of the unit in the header; of an empty one where the header names none or there is no header.
    /// @throws InputError
    std::function<double(const std::string& unit, const InputLocation&)> findFactor;
};

/// Two columns, frequency in Hz and a value; a header is optional. @throws InputError with file and line
Breakpoints parseBreakpoints(std::string_view text, const std::string& file, const BreakpointColumn& column);

}  // namespace wems
