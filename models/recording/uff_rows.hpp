/// @file
/// Rows of a universal file.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "models/recording/row_source.hpp"
#include "models/recording/text_file.hpp"
#include "models/recording/uff_numbers.hpp"
#include "models/recording/uff_reader.hpp"

namespace wems {

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
