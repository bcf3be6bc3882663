/// @file
/// Rows of a MATLAB 7.3 or other HDF5 file.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "models/recording/mat_reader.hpp"
#include "models/recording/row_source.hpp"

namespace wems {

/// The arrays stay in the file, from which HDF5 reads a few thousand samples of each at a time. One that is compressed
/// in pieces longer than 16 MB is slow, since a piece is then inflated anew for each of these parts.
class Hdf5Rows : public RowSource {
public:
    Hdf5Rows(const std::string& file, const ColumnMap* map);

    const Recording& header() const override { return plan_.recording; }
    double expectedSamples() const override { return static_cast<double>(sample_count_); }
    bool append(Recording& rows) override;

private:
    MatTable content_;
    TablePlan plan_;
    std::size_t sample_count_ = 0, samples_read_ = 0;
};

}  // namespace wems
