/// @file
/// Rows of OpenSim's text formats.
#pragma once

#include <string>

#include "models/recording/opensim_reader.hpp"
#include "models/recording/row_source.hpp"
#include "models/recording/text_file.hpp"

namespace wems {

/// A `.trc`, `.sto` or `.mot`, a few thousand rows at a time.
class OpensimRows : public RowSource {
public:
    OpensimRows(const std::string& file, const ColumnMap* map);

    const Recording& header() const override { return plan_.recording; }
    double expectedSamples() const override { return expected_samples_; }
    bool hasPositions() const override { return plan_.positions; }
    bool append(Recording& rows) override;

private:
    TextFile text_;
    LineCursor lines_;
    TablePlan plan_;
    std::size_t column_count_ = 0;  // in the file
    std::size_t rows_read_ = 0;
    double expected_samples_ = 0;
};

}  // namespace wems
