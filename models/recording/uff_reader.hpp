/// @file
/// Universal File Format, dataset 58 (function at nodal degree of freedom), ASCII and binary (58b), many to a file.
///
/// Time responses are read (function type 1, or 0 and 12 over time), everything else is listed as unused. A column is
/// called `<node>:<direction>`, `12:+Z`, with the entity's name before it where there is one, `WING:12:+Z`, and the
/// ordinate's kind after it where several are recorded there, `12:+Z force`; a column map may use the first ID line
/// instead. Units are those of the ordinate's label; without a label, those that a
/// dataset 164 (units) states for the ordinate's kind.
///
/// Source: Structural Dynamics Research Laboratory, University of Cincinnati, Universal File Formats for Modal Analysis
/// Testing, datasets 58, 58b and 164. Binary numbers are IEEE 754, of either byte order.
#pragma once

#include <string>
#include <string_view>

#include "models/recording/recording_table.hpp"

namespace wems {

/// True if `text` begins as a universal file does: a line `-1`, then a line with a dataset's number.
bool isUniversalFile(std::string_view text);

/// @throws InputError with file and line: no time response, cut off, numbers of DEC or IBM, responses of different
///         length or time.
RecordingTable readUniversalFile(std::string_view text, const std::string& file);

}  // namespace wems
