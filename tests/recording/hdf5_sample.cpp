#include "tests/recording/hdf5_sample.hpp"

#include <stdexcept>

namespace wems::test {

Hdf5Sample::Hdf5Sample(const std::string& file)
    : file_(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)) {}

void Hdf5Sample::add(const char* name, const std::vector<hsize_t>& dims, const std::vector<hsize_t>& chunk, bool single,
                     const std::vector<double>& values) const {
    const int rank = static_cast<int>(dims.size());
    const hid_t space = H5Screate_simple(rank, dims.data(), nullptr), creation = H5Pcreate(H5P_DATASET_CREATE);
    if (!chunk.empty()) {
        H5Pset_chunk(creation, rank, chunk.data());
        H5Pset_deflate(creation, 1);
    }
    const hid_t dataset =
        H5Dcreate2(file_, name, single ? H5T_IEEE_F32LE : H5T_IEEE_F64BE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    const herr_t written = H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(dataset);
    H5Pclose(creation);
    H5Sclose(space);
    if (written < 0) throw std::runtime_error("an HDF5 sample cannot be written");
}

void Hdf5Sample::mark(const char* name, const char* attribute, int value) const {
    const hid_t dataset = H5Dopen2(file_, name, H5P_DEFAULT), space = H5Screate(H5S_SCALAR);
    const hid_t made = H5Acreate2(dataset, attribute, H5T_STD_I32LE, space, H5P_DEFAULT, H5P_DEFAULT);
    const herr_t written = H5Awrite(made, H5T_NATIVE_INT, &value);
    H5Aclose(made);
    H5Sclose(space);
    H5Dclose(dataset);
    if (written < 0) throw std::runtime_error("an HDF5 sample cannot be written");
}

}  // namespace wems::test
