/// @file
/// MATLAB files, versions 4, 5 (to 7) and 7.3, and other HDF5 files.
///
/// Every numeric vector is a column, called as MATLAB calls it: `az`, `run.az`, `channel(3).data`; where the file holds
/// nothing but one structure its own name is left out. A matrix gives a column for each channel along its longer side
/// `data.1`, `data.2` …, or called by a list of as many names beside it (`names`, `labels`, `channels`, `headers`,
/// `colheaders`), with a list of `units` likewise. A structure that holds `data` (or `values`, `value`, `y`) and a
/// `name` (or `label`, `title`) is a column of that name, its unit from `unit` or `units`. Since MATLAB's names have no
/// points, `mobile_1_x` is read as `mobile.1.x`. Without units, a column that bears a channel's name is SI; one that
/// the column map names needs its unit there. Texts and scalars become metadata.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "models/recording/mat_file.hpp"
#include "models/recording/recording_stream.hpp"
#include "models/recording/recording_table.hpp"

namespace wems {

/// A channel of an array of numbers.
struct MatSeries {
    const MatValue* array = nullptr;
    bool down = true;         ///< samples run down the array's columns, a column for each channel
    std::size_t channel = 0;  ///< along the other side

    std::size_t sampleCount() const { return down ? array->rows : array->columns; }
    /// @throws InputError: damaged
    std::vector<double> read(std::size_t first, std::size_t count) const;
};

struct MatTable {
    std::shared_ptr<const MatFile> content;  ///< has the arrays of the series
    RecordingTable table;                    ///< without values
    std::vector<MatSeries> series;           ///< of each column
};
/// The columns of a file.
/// @throws InputError: there is none
MatTable tabulateMat(MatFile content, const std::string& file);

/// The table with the values of all its series.
/// @throws InputError: damaged
RecordingTable takeValues(MatTable read);

/// @param hdf5 true for version 7.3 and other HDF5 files
/// @throws InputError
RecordingTable readMat(const std::string& file, bool hdf5);

// Rows of a MATLAB 7.3 or other HDF5 file.

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
