/// @file
/// Rows of LabVIEW's text measurement file.
#pragma once

#include <cstddef>
#include <string>

#include "models/recording/lvm_reader.hpp"
#include "models/recording/row_source.hpp"
#include "models/recording/text_file.hpp"

namespace wems {

/// A `.lvm`, a few thousand rows at a time.
class LvmRows : public RowSource {
public:
    LvmRows(const std::string& file, const ColumnMap* map);

    const Recording& header() const override { return plan_.recording; }
    double expectedSamples() const override { return expected_samples_; }
    bool append(Recording& rows) override;

private:
    bool exceedsPacket() const;

    TextFile text_;
    LineCursor lines_;
    LvmRowForm form_;
    TablePlan plan_;
    double expected_samples_ = 0;
    std::size_t samples_read_ = 0;
};

}  // namespace wems
