#include "models/recording/stored_dataset.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "models/error.hpp"

namespace wems {
namespace {

constexpr double kMostCached = 16e6;  // bytes of a dataset's chunks
constexpr hsize_t kMostSlots = 100000;

/// With a cache for the chunks that hold one sample of every channel, so that none is inflated anew for each block
/// of samples. The channels run along the shorter dimension.
hid_t makeAccess(hid_t dataset) {
    const hid_t access = H5Pcreate(H5P_DATASET_ACCESS);
    const Hdf5Handle creation(H5Dget_create_plist(dataset), H5Pclose);
    std::array<hsize_t, 2> chunk{1, 1};
    if (H5Pget_layout(creation.get()) != H5D_CHUNKED || H5Pget_chunk(creation.get(), 2, chunk.data()) < 1)
        return access;
    const auto dims = findDimensions(dataset);
    const std::size_t across = dims.size() == 2 && dims[1] < dims[0] ? 1 : 0;
    const hsize_t beside = dims.size() == 2 ? (dims[across] - 1) / chunk[across] + 1 : 1;
    const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
    const double bytes =
        static_cast<double>(beside * chunk[0] * chunk[1]) * static_cast<double>(H5Tget_size(type.get()));
    // As many slots as HDF5 recommends, a hundred for each chunk; what is read whole goes first.
    H5Pset_chunk_cache(access, static_cast<std::size_t>(std::min<hsize_t>(100 * beside, kMostSlots)) + 1,
                       static_cast<std::size_t>(std::min(bytes, kMostCached)), 1.0);
    return access;
}

}  // namespace

std::vector<hsize_t> findDimensions(hid_t dataset) {
    const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
    std::vector<hsize_t> dims(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space.get()))));
    if (!dims.empty()) H5Sget_simple_extent_dims(space.get(), dims.data(), nullptr);
    return dims;
}

StoredDataset::StoredDataset(hid_t dataset, std::string file)
    : file_(std::move(file)),
      access_(makeAccess(dataset), H5Pclose),
      dataset_(H5Dopen2(dataset, ".", access_.get()), H5Dclose) {}

std::vector<double> StoredDataset::read(std::size_t row, std::size_t rows, std::size_t column,
                                        std::size_t columns) const {
    const QuietErrors quiet;
    const Hdf5Handle space(H5Dget_space(dataset_.get()), H5Sclose);
    const bool flat = H5Sget_simple_extent_ndims(space.get()) == 1;
    const std::array<hsize_t, 2> start{flat ? row + column : column, row}, size{flat ? rows * columns : columns, rows};
    const hsize_t count = rows * columns;
    const Hdf5Handle memory(H5Screate_simple(1, &count, nullptr), H5Sclose);
    std::vector<double> numbers(count);
    if (H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr) < 0 ||
        H5Dread(dataset_.get(), H5T_NATIVE_DOUBLE, memory.get(), space.get(), H5P_DEFAULT, numbers.data()) < 0)
        throw InputError({file_, 0, {}}, "is damaged: numbers of a dataset cannot be read");
    return numbers;
}

}  // namespace wems
