/// @file
/// HDF5 files, MATLAB 7.3 among them, as the tree that MATLAB files give.
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "models/recording/mat_file.hpp"

namespace wems {

// What every use of the HDF5 library needs.

/// An identifier of the library, closed at the end of the scope.
class Hdf5Handle {
public:
    Hdf5Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
    ~Hdf5Handle() {
        if (id_ >= 0) close_(id_);
    }
    Hdf5Handle(const Hdf5Handle&) = delete;
    Hdf5Handle& operator=(const Hdf5Handle&) = delete;
    hid_t get() const { return id_; }
    explicit operator bool() const { return id_ >= 0; }

private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

/// Keeps the library from printing its own messages.
class QuietErrors {
public:
    QuietErrors() {
        H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    }
    ~QuietErrors() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
    QuietErrors(const QuietErrors&) = delete;
    QuietErrors& operator=(const QuietErrors&) = delete;

private:
    H5E_auto2_t function_ = nullptr;
    void* data_ = nullptr;
};

// A dataset of an HDF5 file that is read in parts.

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

/// Groups become structures (groups whose members are lists of references: arrays of structures), datasets numbers,
/// texts or, with references, cells. Compound types (complex numbers) are named and not read.
/// @param most_read arrays of more numbers than that, of one or two dimensions, stay in the file, which is open as long
///                  as one of them lives
/// @throws InputError: not such a file, damaged.
MatFile readHdf5File(const std::string& file, std::size_t most_read = std::numeric_limits<std::size_t>::max());

}  // namespace wems
