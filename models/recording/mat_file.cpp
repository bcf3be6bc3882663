#include "models/recording/mat_file.hpp"

#include <matio.h>

#include <algorithm>
#include <cstdint>
#include <memory>

#include "models/error.hpp"
#include "models/recording/utf8.hpp"

namespace wems {
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
