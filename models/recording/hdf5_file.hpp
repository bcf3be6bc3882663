/// @file
/// HDF5 files, MATLAB 7.3 among them, as the tree that MATLAB files give.
#pragma once

#include "models/recording/mat_file.hpp"

namespace wems {

/// Groups become structures (groups whose members are lists of references: arrays of structures), datasets numbers,
/// texts or, with references, cells. Compound types (complex numbers) are named and not read.
/// @throws InputError: not such a file, damaged.
MatFile readHdf5File(const std::string& file);

}  // namespace wems
