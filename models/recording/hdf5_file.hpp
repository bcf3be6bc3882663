/// @file
/// HDF5 files, MATLAB 7.3 among them, as the tree that MATLAB files give.
#pragma once

#include <cstddef>
#include <limits>

#include "models/recording/mat_file.hpp"

namespace wems {

/// Groups become structures (groups whose members are lists of references: arrays of structures), datasets numbers,
/// texts or, with references, cells. Compound types (complex numbers) are named and not read.
/// @param most_read arrays of more numbers than that, of one or two dimensions, stay in the file, which is open as long
///                  as one of them lives
/// @throws InputError: not such a file, damaged.
MatFile readHdf5File(const std::string& file, std::size_t most_read = std::numeric_limits<std::size_t>::max());

}  // namespace wems
