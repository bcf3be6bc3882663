#include "models/recording/hdf5_file.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <utility>

#include "models/common/error.hpp"
#include "models/common/text_file.hpp"

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

namespace {

constexpr int kDeepestGroup = 20;         // groups in groups, references to references
constexpr long kMostObjects = 1000000;    // a file that refers to itself in circles ends here
constexpr double kMostCompressed = 1100;  // deflate reaches 1032

herr_t collectName(hid_t, const char* name, const H5L_info_t*, void* target) {
    static_cast<std::vector<std::string>*>(target)->emplace_back(name);
    return 0;
}

/// A fixed-length text of a scalar or an array, cut at the first zero byte.
std::string cutText(const char* bytes, std::size_t size) {
    const std::string text(bytes, size);
    const auto end = text.find('\0');
    return end == std::string::npos ? text : text.substr(0, end);
}

class TreeReader {
public:
    TreeReader(const std::string& file, std::size_t most_read) : file_(file), most_read_(most_read) {
        std::error_code ignored;
        limit_ = 1e6 + kMostCompressed * static_cast<double>(std::filesystem::file_size(file, ignored));
    }

    MatFile read() {
        const QuietErrors quiet;
        const Hdf5Handle handle(H5Fopen(file_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
        if (!handle) throw InputError({file_, 0, {}}, "is not a MATLAB 7.3 or HDF5 file, or is damaged", "HDF5");
        const Hdf5Handle plist(H5Fget_create_plist(handle.get()), H5Pclose);
        hsize_t user_block = 0;
        if (plist) H5Pget_userblock(plist.get(), &user_block);
        MatFile result;
        result.version = user_block >= 512 ? "MATLAB 7.3" : "HDF5";
        const Hdf5Handle root(H5Gopen2(handle.get(), "/", H5P_DEFAULT), H5Gclose);
        result.root = readFields(root.get(), 0);
        if (result.root.fields.empty()) throw InputError({file_, 0, {}}, "holds no variable, or is damaged");
        return result;
    }

private:
    std::vector<std::string> listMembers(hid_t group) const {
        std::vector<std::string> names;
        H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, collectName, &names);
        // MATLAB's own: the targets of references, and objects.
        names.erase(std::remove_if(names.begin(), names.end(), [](const auto& name) { return name.front() == '#'; }),
                    names.end());
        return names;
    }

    MatValue readFields(hid_t group, int depth) {
        MatValue element;
        for (const auto& name : listMembers(group)) {
            const Hdf5Handle object(H5Oopen(group, name.c_str(), H5P_DEFAULT), H5Oclose);
            element.fields.emplace_back(name, readObject(object.get(), depth + 1));
        }
        return element;
    }

    MatValue readObject(hid_t object, int depth) {
        if (object < 0 || depth > kDeepestGroup || ++objects_ > kMostObjects) return {};
        // MATLAB's objects and functions: their numbers are places in a store of its own.
        if (H5Aexists(object, "MATLAB_object_decode") > 0) return {};
        switch (H5Iget_type(object)) {
            case H5I_GROUP:
                return readGroup(object, depth);
            case H5I_DATASET:
                return readDataset(object, depth);
            default:
                return {};
        }
    }

    MatValue readGroup(hid_t group, int depth) {
        MatValue value;
        if (H5Aexists(group, "MATLAB_sparse") > 0) return value;
        value.kind = MatValue::Kind::structs;
        MatValue fields = readFields(group, depth);
        // An array of structures: every field is a list of references, which are no cells.
        const auto isList = [&](const auto& field) {
            const Hdf5Handle dataset(H5Dopen2(group, field.first.c_str(), H5P_DEFAULT), H5Dclose);
            return dataset && field.second.kind == MatValue::Kind::cells && readClass(dataset.get()).empty() &&
                   field.second.elements.size() == fields.fields.front().second.elements.size();
        };
        if (!fields.fields.empty() && std::all_of(fields.fields.begin(), fields.fields.end(), isList)) {
            value.elements.resize(fields.fields.front().second.elements.size());
            for (auto& [name, list] : fields.fields) {
                for (std::size_t i = 0; i < value.elements.size(); ++i)
                    value.elements[i].fields.emplace_back(name, std::move(list.elements[i]));
            }
        } else {
            value.elements.push_back(std::move(fields));
        }
        return value;
    }

    /// The attribute MATLAB_class; empty if there is none.
    static std::string readClass(hid_t dataset) {
        if (H5Aexists(dataset, "MATLAB_class") <= 0) return {};
        const Hdf5Handle attribute(H5Aopen(dataset, "MATLAB_class", H5P_DEFAULT), H5Aclose);
        if (!attribute) return {};
        const Hdf5Handle type(H5Aget_type(attribute.get()), H5Tclose);
        if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) > 0) return {};
        const std::size_t size = H5Tget_size(type.get());
        const Hdf5Handle space(H5Aget_space(attribute.get()), H5Sclose);
        if (size == 0 || size > 64 || H5Sget_simple_extent_npoints(space.get()) != 1) return {};
        std::vector<char> bytes(size);
        // In the file's own type, since a conversion would cut texts that fill their length.
        if (H5Aread(attribute.get(), type.get(), bytes.data()) < 0) return {};
        return cutText(bytes.data(), size);
    }

    MatValue readDataset(hid_t dataset, int depth) {
        MatValue value;
        const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
        const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
        if (!space || !type || H5Sget_simple_extent_type(space.get()) == H5S_NULL) return value;
        const std::vector<hsize_t> dims = findDimensions(dataset);
        double count = 1;
        for (const hsize_t dim : dims) count *= static_cast<double>(dim);
        if (count * 8 > limit_)
            throw InputError({file_, 0, {}}, "a dataset claims more numbers than the file can hold; it is damaged");
        const bool empty = H5Aexists(dataset, "MATLAB_empty") > 0;
        if (empty || count < 1) return value;
        const auto size = static_cast<std::size_t>(count);
        switch (H5Tget_class(type.get())) {
            case H5T_INTEGER:
            case H5T_FLOAT:
            case H5T_ENUM:
                readNumbers(dataset, dims, size, value);
                break;
            case H5T_REFERENCE:
                readReferences(dataset, type.get(), size, depth, value);
                break;
            case H5T_STRING:
                readTexts(dataset, type.get(), size, value);
                break;
            default:
                break;
        }
        return value;
    }

    /// Row by row of the dataset is column by column of MATLAB's array, whose dimensions stand in reverse.
    void readNumbers(hid_t dataset, const std::vector<hsize_t>& dims, std::size_t size, MatValue& value) const {
        value.rows = dims.empty() ? 1 : static_cast<std::size_t>(dims.back());
        value.columns = size / value.rows;
        if (dims.size() == 1) std::swap(value.rows, value.columns);
        const bool is_text = readClass(dataset) == "char";
        if (size > most_read_ && dims.size() <= 2 && !is_text) {
            value.kind = MatValue::Kind::numbers;
            value.stored = std::make_shared<StoredDataset>(dataset, file_);
            return;
        }
        value.numbers.resize(size);
        if (H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, value.numbers.data()) < 0) {
            value.numbers.clear();
            return;
        }
        value.kind = MatValue::Kind::numbers;
        if (is_text) makeText(value);
    }

    /// Character codes to texts, one for each row.
    static void makeText(MatValue& value) {
        for (std::size_t row = 0; row < value.rows; ++row) {
            std::string text;
            for (std::size_t column = 0; column < value.columns; ++column) {
                const double code = value.numbers[column * value.rows + row];
                if (code >= 1 && code <= 0xFFFF) appendUtf8(static_cast<std::uint32_t>(code), text);
            }
            text.resize(text.find_last_not_of(" \t\r\n") + 1);
            value.texts.push_back(std::move(text));
        }
        value.kind = MatValue::Kind::text;
        value.numbers.clear();
    }

    void readReferences(hid_t dataset, hid_t type, std::size_t size, int depth, MatValue& value) {
        if (H5Tequal(type, H5T_STD_REF_OBJ) <= 0) return;
        std::vector<hobj_ref_t> references(size);
        if (H5Dread(dataset, H5T_STD_REF_OBJ, H5S_ALL, H5S_ALL, H5P_DEFAULT, references.data()) < 0) return;
        value.kind = MatValue::Kind::cells;
        for (const auto& reference : references) {
            const Hdf5Handle object(H5Rdereference2(dataset, H5P_DEFAULT, H5R_OBJECT, &reference), H5Oclose);
            value.elements.push_back(readObject(object.get(), depth + 1));
        }
    }

    void readTexts(hid_t dataset, hid_t type, std::size_t size, MatValue& value) const {
        const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
        if (H5Tis_variable_str(type) > 0) {
            std::vector<char*> texts(size, nullptr);
            const Hdf5Handle memory(H5Tcopy(type), H5Tclose);
            if (H5Dread(dataset, memory.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data()) < 0) return;
            for (const char* text : texts) value.texts.emplace_back(text != nullptr ? text : "");
            H5Dvlen_reclaim(memory.get(), space.get(), H5P_DEFAULT, texts.data());
        } else {
            const std::size_t length = H5Tget_size(type);
            if (static_cast<double>(length) * static_cast<double>(size) > limit_) return;
            std::vector<char> bytes(length * size);
            if (H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) < 0) return;
            for (std::size_t i = 0; i < size; ++i) value.texts.push_back(cutText(bytes.data() + i * length, length));
        }
        value.kind = MatValue::Kind::text;
    }

    const std::string& file_;
    std::size_t most_read_;
    double limit_ = 0;  // bytes that the file can hold
    long objects_ = 0;
};

}  // namespace

MatFile readHdf5File(const std::string& file, std::size_t most_read) {
    return TreeReader(file, most_read).read();
}

}  // namespace wems
