/// @file
/// A dataset of an HDF5 file that is read in parts.
#pragma once

#include <string>
#include <vector>

#include "models/recording/hdf5_handle.hpp"
#include "models/recording/mat_file.hpp"

namespace wems {

/// Lengths along the dimensions of a dataset, none of a scalar.
std::vector<hsize_t> findDimensions(hid_t dataset);

/// A dataset of one or two dimensions, read by hyperslabs. MATLAB's rows run along its last dimension. Its file stays
/// open.
class StoredDataset : public StoredNumbers {
public:
    StoredDataset(hid_t dataset, std::string file);

    std::vector<double> read(std::size_t row, std::size_t rows, std::size_t column, std::size_t columns) const override;

private:
    std::string file_;
    Hdf5Handle access_, dataset_;
};

}  // namespace wems
