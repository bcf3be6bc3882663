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

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "models/common/text_file.hpp"
#include "models/recording/recording_stream.hpp"
#include "models/recording/recording_table.hpp"
#include "models/recording/uff_function.hpp"

namespace wems {

/// True if `text` begins as a universal file does: a line `-1`, then a line with a dataset's number.
bool isUniversalFile(std::string_view text);

/// A table of time and time responses, and which function each column after the time is.
struct UffTable {
    RecordingTable table;
    std::vector<std::size_t> functions;
};

/// All datasets 58 of a file and where their numbers stand, none of which is read: responses of uneven spacing are
/// taken to have the times of the first one.
struct UffIndex {
    std::vector<UffFunction> functions;
    std::vector<UffExtent> extents;  ///< of each function; views into the text
    UffTable table;                  ///< without values
};
/// @param pass called now and then on the way through the file
/// @throws InputError as readUniversalFile(), but for the numbers
UffIndex indexUniversalFile(std::string_view text, const std::string& file, const std::function<void()>& pass);

/// @throws InputError with file and line: no time response, cut off, numbers of DEC or IBM, responses of different
///         length or time.
RecordingTable readUniversalFile(std::string_view text, const std::string& file);

// Rows of a universal file.

/// One function stands behind another in the file: each is read from a place of its own, a few thousand points at a
/// time. The file is walked through once beforehand, to find them.
class UffRows : public RowSource {
public:
    UffRows(const std::string& file, const ColumnMap* map);

    const Recording& header() const override { return plan_.recording; }
    double expectedSamples() const override { return static_cast<double>(point_count_); }
    bool append(Recording& rows) override;

private:
    struct Series {
        UffFunction function;  // its values are those that no row has had yet
        UffNumberReader reader;
    };
    std::vector<double> takeValues(Series& series, std::size_t points) const;

    std::string file_;
    TextFile text_;
    TablePlan plan_;
    std::vector<Series> series_;     // of the columns that are used; the time is that of the first one
    std::vector<std::size_t> used_;  // series of each column of the plan
    std::size_t point_count_ = 0, points_read_ = 0;
};

}  // namespace wems
