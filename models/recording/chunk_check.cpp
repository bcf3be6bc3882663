#include "models/recording/chunk_check.hpp"

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "models/recording/inflate.hpp"

namespace wems {
namespace {

/// Filters of a dataset, as far as they keep the length of a chunk or inflate to it.
struct Filters {
    bool known = true;
    int deflate = -1;  ///< its place among them, -1 without
};

Filters findFilters(hid_t creation) {
    Filters filters;
    const int count = H5Pget_nfilters(creation);
    for (int i = 0; i < count; ++i) {
        unsigned flags = 0, configuration = 0;
        std::size_t values = 0;
        const H5Z_filter_t filter =
            H5Pget_filter2(creation, static_cast<unsigned>(i), &flags, &values, nullptr, 0, nullptr, &configuration);
        if (filter == H5Z_FILTER_DEFLATE) {
            filters.deflate = i;
        } else if (filter != H5Z_FILTER_SHUFFLE) {
            filters.known = false;
        }
    }
    return filters;
}

}  // namespace

bool hasChunksOfItsSize(hid_t dataset, std::size_t file_size) {
    const Hdf5Handle creation(H5Dget_create_plist(dataset), H5Pclose);
    if (H5Pget_layout(creation.get()) != H5D_CHUNKED) return true;
    const Filters filters = findFilters(creation.get());
    if (!filters.known) return true;
    std::array<hsize_t, H5S_MAX_RANK> chunk{}, offset{};
    const int rank = H5Pget_chunk(creation.get(), H5S_MAX_RANK, chunk.data());
    const Hdf5Handle space(H5Dget_space(dataset), H5Sclose), type(H5Dget_type(dataset), H5Tclose);
    hsize_t count = 0, size = 0;
    if (rank < 1 || H5Dget_num_chunks(dataset, space.get(), &count) < 0) return false;
    if (count == 0) return true;
    double length = static_cast<double>(H5Tget_size(type.get()));
    for (int i = 0; i < rank; ++i) length *= static_cast<double>(chunk.at(static_cast<std::size_t>(i)));
    unsigned skipped = 0;
    haddr_t address = 0;
    if (H5Dget_chunk_info(dataset, space.get(), 0, offset.data(), &skipped, &address, &size) < 0) return false;
    // Once more by its place, as reading finds it: in a damaged file that may be another entry of the index.
    if (H5Dget_chunk_storage_size(dataset, offset.data(), &size) < 0 || size > file_size) return false;
    const bool deflated = filters.deflate >= 0 && (skipped >> static_cast<unsigned>(filters.deflate) & 1U) == 0;
    if (!deflated) return static_cast<double>(size) == length;
    std::vector<char> bytes(size);
    std::uint32_t mask = 0;
    if (H5Dread_chunk(dataset, H5P_DEFAULT, offset.data(), &mask, bytes.data()) < 0) return false;
    const Inflated inflated = inflateAll(std::string_view(bytes.data(), bytes.size()));
    return inflated.complete && static_cast<double>(inflated.plain.size()) == length;
}

}  // namespace wems
