/// @file
/// What writes an HDF5 file: the library itself, one dataset after the other.
#pragma once

#include <hdf5.h>

#include <string>
#include <vector>

namespace wems::test {

class Hdf5Sample {
public:
    explicit Hdf5Sample(const std::string& file);
    ~Hdf5Sample() { H5Fclose(file_); }
    Hdf5Sample(const Hdf5Sample&) = delete;
    Hdf5Sample& operator=(const Hdf5Sample&) = delete;

    /// @param chunk none: the numbers stand on end; otherwise they are compressed in pieces of this size
    void add(const char* name, const std::vector<hsize_t>& dims, const std::vector<hsize_t>& chunk, bool single,
             const std::vector<double>& values) const;
    /// Gives a dataset an attribute, an integer.
    void mark(const char* name, const char* attribute, int value) const;

private:
    hid_t file_;
};

}  // namespace wems::test
