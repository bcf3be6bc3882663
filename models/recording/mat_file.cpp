#include "models/recording/mat_file.hpp"

#include <matio.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include "models/common/error.hpp"
#include "models/common/text_file.hpp"

namespace wems {

Inflated inflateAll(std::string_view stream) {
    constexpr std::size_t kPiece = 1 << 18;
    z_stream state;
    std::memset(&state, 0, sizeof state);
    if (inflateInit(&state) != Z_OK) return {};
    std::vector<Bytef> piece(kPiece), input;
    Inflated result;
    int status = Z_OK;
    while (status == Z_OK) {
        if (state.avail_in == 0 && !stream.empty()) {
            const std::size_t count = std::min(stream.size(), kPiece);
            input.assign(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(count));  // zlib wants it mutable
            stream.remove_prefix(count);
            state.next_in = input.data();
            state.avail_in = static_cast<uInt>(count);
        }
        state.next_out = piece.data();
        state.avail_out = static_cast<uInt>(kPiece);
        status = inflate(&state, Z_NO_FLUSH);  // Z_BUF_ERROR where the stream is cut off
        result.plain.append(piece.begin(), piece.end() - static_cast<std::ptrdiff_t>(state.avail_out));
    }
    inflateEnd(&state);
    result.complete = status == Z_STREAM_END;
    return result;
}

namespace {

constexpr std::uint32_t kInt32 = 5, kUint32 = 6, kMatrix = 14, kCompressed = 15;                // types of elements
constexpr std::uint32_t kCell = 1, kStructure = 2, kSparse = 5, kLastNumeric = 15, kLast = 17;  // classes of arrays
constexpr std::size_t kHeader = 128, kTag = 8;
constexpr int kDeepestElement = 64;

class ExtentCheck {
public:
    ExtentCheck(std::string_view content, const std::string& file) : content_(content), file_(file) {}

    void run() {
        if (content_.substr(0, 10) == "MATLAB 5.0") {
            swapped_ = content_.substr(126, 2) == "MI";
            for (std::size_t at = kHeader; at + kTag <= content_.size();)
                at = checkElement(at, content_.size(), 0).next;
        } else {
            checkVersion4();
        }
    }

private:
    struct Element {
        std::uint32_t type = 0;
        std::size_t begin = 0, size = 0;  // of its data
        std::size_t next = 0;
    };

    std::uint32_t read(std::size_t at) const {
        if (at + 4 > content_.size()) fail(at);
        std::uint32_t word = 0;
        std::memcpy(&word, content_.data() + at, sizeof word);
        return swapped_ ? __builtin_bswap32(word) : word;
    }

    [[noreturn]] void fail(std::size_t at) const {
        throw InputError(
            {file_, 0, {}},
            "is damaged or cut off: what stands at byte " + std::to_string(at) + place_ + " reaches beyond its end",
            "a complete MATLAB file");
    }

    Element readTag(std::size_t at, std::size_t end) const {
        Element element;
        const std::uint32_t first = read(at);
        if (first >> 16U != 0) {  // up to four bytes within the tag
            element = {first & 0xFFFFU, at + 4, first >> 16U, at + kTag};
            if (element.size > 4 || element.next > end) fail(at);
            return element;
        }
        element = {first, at + kTag, read(at + 4), 0};
        if (element.size > end - std::min(end, element.begin)) fail(at);
        const std::size_t padding = first == kCompressed ? 0 : (8 - element.size % 8) % 8;
        element.next = element.begin + element.size + padding;
        return element;
    }

    Element checkElement(std::size_t at, std::size_t end, int depth) const {
        const Element element = readTag(at, end);
        if (element.type == kMatrix && element.size > 0 && depth < kDeepestElement) checkArray(element, depth);
        if (element.type == kCompressed) checkCompressed(element);
        return element;
    }

    /// A variable alone, which may claim more than its stream holds.
    void checkCompressed(const Element& element) const {
        const Inflated inflated = inflateAll(content_.substr(element.begin, element.size));
        ExtentCheck inside(inflated.plain, file_);
        inside.swapped_ = swapped_;
        inside.place_ = " of the variable compressed at byte " + std::to_string(element.begin);
        if (!inflated.complete)
            throw InputError({file_, 0, {}},
                             "the variable compressed at byte " + std::to_string(element.begin) + " is damaged",
                             "a complete MATLAB file");
        if (inside.readTag(0, inflated.plain.size()).type == kMatrix) inside.checkElement(0, inflated.plain.size(), 0);
    }

    void checkArray(const Element& array, int depth) const {
        const std::size_t end = array.begin + array.size;
        const Element flags = readTag(array.begin, end);
        const std::uint32_t kind = read(flags.begin) & 0xFFU;
        if (flags.type != kUint32 || flags.size != kTag || kind < kCell || kind > kLast) fail(flags.begin);
        if (kind == kSparse || kind > kLastNumeric) return;  // dimensions of another meaning, objects
        const Element dimensions = readTag(std::min(flags.next, end), end);
        // Signed by the format; some programs write them unsigned.
        if (dimensions.type != kInt32 && dimensions.type != kUint32) fail(dimensions.begin);
        double elements = 1;
        for (std::size_t k = 0; k + 4 <= dimensions.size; k += 4) elements *= read(dimensions.begin + k);
        const Element name = readTag(std::min(dimensions.next, end), end);
        std::size_t at = name.next;
        double least = 1;  // bytes of an element
        if (kind == kCell) least = kTag;
        if (kind == kStructure) {
            const Element length = readTag(std::min(at, end), end);
            const std::uint32_t field = read(length.begin);
            const Element names = readTag(std::min(length.next, end), end);
            if (length.type != kInt32 || length.size != 4 || field == 0 || names.size % field != 0) fail(length.begin);
            least = kTag * (static_cast<double>(names.size) / field);
            at = names.next;
        }
        if (elements * least > static_cast<double>(array.size)) fail(dimensions.begin);
        while (at + kTag <= end) at = checkElement(at, end, depth + 1).next;
    }

    void checkVersion4() {
        constexpr std::size_t kHead = 20;
        constexpr double kWidths[] = {8, 4, 4, 2, 2, 1};
        swapped_ = content_.size() >= 4 && read(0) > 9999;
        for (std::size_t at = 0; at + kHead <= content_.size();) {
            const std::uint32_t precision = read(at) / 10 % 10;
            if (precision > 5) fail(at);
            const double values = static_cast<double>(read(at + 4)) * read(at + 8) * (read(at + 12) != 0 ? 2 : 1);
            const double size = kHead + read(at + 16) + values * kWidths[precision];
            if (size > static_cast<double>(content_.size() - at)) fail(at);
            at += static_cast<std::size_t>(size);
        }
    }

    std::string_view content_;
    const std::string& file_;
    std::string place_;  // of the content in the file, if it is not the file itself
    bool swapped_ = false;
};

}  // namespace

void checkMatExtent(std::string_view content, const std::string& file) {
    ExtentCheck(content, file).run();
}

namespace {

constexpr int kDeepestStructure = 20;  // structures in structures

struct FileCloser {
    void operator()(mat_t* file) const { Mat_Close(file); }
};
struct VariableFreer {
    void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};

std::size_t countElements(const matvar_t& variable) {
    std::size_t count = variable.rank > 0 ? 1 : 0;
    for (int i = 0; i < variable.rank; ++i) count *= variable.dims[i];
    return count;
}

template <typename T>
void appendNumbers(const matvar_t& variable, std::size_t count, std::vector<double>& numbers) {
    const auto* data = static_cast<const T*>(variable.data);
    numbers.resize(count);
    for (std::size_t i = 0; i < count; ++i) numbers[i] = static_cast<double>(data[i]);
}

/// False if the type of the data is none of numbers.
bool readNumbers(const matvar_t& variable, std::size_t count, std::vector<double>& numbers) {
    switch (variable.data_type) {
        case MAT_T_DOUBLE:
            appendNumbers<double>(variable, count, numbers);
            return true;
        case MAT_T_SINGLE:
            appendNumbers<float>(variable, count, numbers);
            return true;
        case MAT_T_INT8:
            appendNumbers<std::int8_t>(variable, count, numbers);
            return true;
        case MAT_T_UINT8:
            appendNumbers<std::uint8_t>(variable, count, numbers);
            return true;
        case MAT_T_INT16:
            appendNumbers<std::int16_t>(variable, count, numbers);
            return true;
        case MAT_T_UINT16:
            appendNumbers<std::uint16_t>(variable, count, numbers);
            return true;
        case MAT_T_INT32:
            appendNumbers<std::int32_t>(variable, count, numbers);
            return true;
        case MAT_T_UINT32:
            appendNumbers<std::uint32_t>(variable, count, numbers);
            return true;
        case MAT_T_INT64:
            appendNumbers<std::int64_t>(variable, count, numbers);
            return true;
        case MAT_T_UINT64:
            appendNumbers<std::uint64_t>(variable, count, numbers);
            return true;
        default:
            return false;
    }
}

void readText(const matvar_t& variable, MatValue& value) {
    const std::size_t rows = variable.rank > 0 ? variable.dims[0] : 0;
    const std::size_t columns = rows > 0 ? countElements(variable) / rows : 0;
    if (variable.data_type == MAT_T_UTF8 && rows == 1) {
        value.texts.emplace_back(static_cast<const char*>(variable.data), variable.nbytes);
    } else {
        const std::size_t width = variable.data_type == MAT_T_UTF16 || variable.data_type == MAT_T_UINT16 ? 2 : 1;
        // Rows of no length take no bytes: a damaged file can claim any number of them.
        if (width * rows * columns > variable.nbytes || (columns == 0 && rows > 1)) return;
        const auto* bytes = static_cast<const std::uint8_t*>(variable.data);
        const auto* words = static_cast<const std::uint16_t*>(variable.data);
        for (std::size_t row = 0; row < rows; ++row) {
            std::string text;
            for (std::size_t column = 0; column < columns; ++column) {
                const std::size_t index = column * rows + row;
                appendUtf8(width == 2 ? words[index] : bytes[index], text);
            }
            value.texts.push_back(std::move(text));
        }
    }
    for (auto& text : value.texts) {
        const auto last = text.find_last_not_of(std::string_view(" \t\r\n\0", 5));
        text.resize(last == std::string::npos ? 0 : last + 1);
    }
}

MatValue convert(const matvar_t* variable, int depth) {
    MatValue value;
    if (variable == nullptr || variable->data == nullptr || variable->rank < 1 || depth > kDeepestStructure)
        return value;
    const std::size_t count = countElements(*variable);
    const auto elements = [&](std::size_t size) {
        return std::min(count, variable->nbytes / std::max<std::size_t>(1, size));
    };
    switch (variable->class_type) {
        case MAT_C_CHAR:
            value.kind = MatValue::Kind::text;
            readText(*variable, value);
            break;
        case MAT_C_CELL: {
            value.kind = MatValue::Kind::cells;
            auto* const* cells = static_cast<matvar_t* const*>(variable->data);
            for (std::size_t i = 0; i < elements(sizeof(matvar_t*)); ++i)
                value.elements.push_back(convert(cells[i], depth + 1));
            break;
        }
        case MAT_C_STRUCT: {
            value.kind = MatValue::Kind::structs;
            // The library's functions do not change the structure; they lack the const.
            auto* structure = const_cast<matvar_t*>(variable);  // NOLINT(cppcoreguidelines-pro-type-const-cast)
            const unsigned field_count = Mat_VarGetNumberOfFields(structure);
            char* const* names = Mat_VarGetStructFieldnames(structure);
            const std::size_t size = std::max<std::size_t>(1, field_count) * sizeof(matvar_t*);
            for (std::size_t i = 0; i < elements(size); ++i) {
                MatValue element;
                for (unsigned k = 0; names != nullptr && k < field_count; ++k) {
                    if (names[k] == nullptr) continue;
                    element.fields.emplace_back(names[k],
                                                convert(Mat_VarGetStructFieldByIndex(structure, k, i), depth + 1));
                }
                value.elements.push_back(std::move(element));
            }
            break;
        }
        case MAT_C_DOUBLE:
        case MAT_C_SINGLE:
        case MAT_C_INT8:
        case MAT_C_UINT8:
        case MAT_C_INT16:
        case MAT_C_UINT16:
        case MAT_C_INT32:
        case MAT_C_UINT32:
        case MAT_C_INT64:
        case MAT_C_UINT64: {
            const std::size_t width = Mat_SizeOf(variable->data_type);
            if (variable->isComplex != 0 || width == 0 || elements(width) < count) break;
            if (!readNumbers(*variable, count, value.numbers)) break;
            value.kind = MatValue::Kind::numbers;
            value.rows = variable->dims[0];
            value.columns = value.rows > 0 ? count / value.rows : 0;
            break;
        }
        default:
            break;
    }
    return value;
}

}  // namespace

const MatValue* MatValue::find(const std::string& field) const {
    const auto found =
        std::find_if(fields.begin(), fields.end(), [&](const auto& entry) { return entry.first == field; });
    return found == fields.end() ? nullptr : &found->second;
}

MatFile readMatFile(const std::string& file) {
    const std::unique_ptr<mat_t, FileCloser> handle(Mat_Open(file.c_str(), MAT_ACC_RDONLY));
    if (!handle) throw InputError({file, 0, {}}, "is not a MATLAB file, or is damaged", "MAT-file of version 5 or 7.3");
    MatFile result;
    result.version = Mat_GetVersion(handle.get()) == MAT_FT_MAT4 ? "MATLAB 4" : "MATLAB 5";
    for (;;) {
        const std::unique_ptr<matvar_t, VariableFreer> variable(Mat_VarReadNext(handle.get()));
        if (!variable) break;
        const std::string name = variable->name != nullptr ? variable->name : "";
        if (name.empty()) {  // an object, or MATLAB's own store of what objects and functions hold
            result.has_objects = true;
            continue;
        }
        result.root.fields.emplace_back(name, convert(variable.get(), 0));
    }
    if (result.root.fields.empty() && !result.has_objects)
        throw InputError({file, 0, {}}, "no variable can be read from this MATLAB file; is it damaged?",
                         "numeric arrays and structures, saved with -v7 or -v7.3");
    return result;
}

}  // namespace wems
