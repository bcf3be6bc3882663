/// @file
/// Whether what an HDF5 dataset says of its chunks can be true.
#pragma once

#include <cstddef>

#include "models/recording/hdf5_handle.hpp"

namespace wems {

/// False if the first chunk of a dataset is not as long as the dataset says: HDF5 believes the dataset, and reads
/// beyond the chunks of a damaged file. True without chunks, and with filters other than deflate and shuffle, which may
/// change their length.
/// @param file_size bytes
bool hasChunksOfItsSize(hid_t dataset, std::size_t file_size);

}  // namespace wems
