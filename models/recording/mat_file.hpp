/// @file
/// The variables of a MATLAB file as a tree, without its library.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace wems {

// Compressed data as they are without compression.

/// What a zlib stream holds.
struct Inflated {
    std::string plain;      ///< as far as the stream goes
    bool complete = false;  ///< the stream reached its end and its checksum is right
};

/// The memory taken is that of the result, at most 1032 times the stream (deflate's limit), whatever other numbers
/// claim.
Inflated inflateAll(std::string_view stream);

// Whether what a MATLAB file says of its own sizes can be true.

/// Walks through the elements of a file of version 4 or 5 without reading their values: each must lie within the one
/// around it, and an array must not have more elements than bytes. matio believes such numbers and takes gigabytes of
/// memory for a damaged file of a few kilobytes. Compressed variables are inflated for that, one at a time.
///
/// Source: MathWorks, MAT-File Format (R2023a), chapters 1 (version 5) and 2 (version 4).
///
/// @throws InputError: damaged, at which byte
void checkMatExtent(std::string_view content, const std::string& file);

/// An array of numbers that was left in its file.
class StoredNumbers {
public:
    StoredNumbers() = default;
    virtual ~StoredNumbers() = default;
    StoredNumbers(const StoredNumbers&) = delete;
    StoredNumbers& operator=(const StoredNumbers&) = delete;

    /// The part that begins at `row` and `column` and has `rows` and `columns` of them, column by column.
    /// @throws InputError: damaged
    virtual std::vector<double> read(std::size_t row, std::size_t rows, std::size_t column,
                                     std::size_t columns) const = 0;
};

/// A variable, a field or an element.
struct MatValue {
    enum class Kind {
        numbers,  ///< real, of any numeric class
        text,     ///< one string for each row
        cells,    ///< `elements`
        structs,  ///< `elements`, each with `fields`
        other     ///< complex, sparse, objects, functions: named, not read
    };
    Kind kind = Kind::other;
    std::size_t rows = 0, columns = 0;  ///< of numbers; further dimensions are folded into the columns
    std::vector<double> numbers;        ///< column by column; none if they are `stored`
    std::shared_ptr<const StoredNumbers> stored;
    std::vector<std::string> texts;  ///< UTF-8, without blanks at the end
    std::vector<MatValue> elements;
    std::vector<std::pair<std::string, MatValue>> fields;  ///< of an element of a structure

    const MatValue* find(const std::string& field) const;
    /// Of numbers, wherever they are.
    std::size_t count() const { return rows * columns; }
};

struct MatFile {
    std::string version;       ///< `MATLAB 4`, `MATLAB 5`, `MATLAB 7.3`, `HDF5`
    MatValue root;             ///< its fields are the variables that have names
    bool has_objects = false;  ///< beside them are variables of MATLAB's newer classes, which are not read
};

/// Reads every variable of a file of version 4 or 5 (matio). Version 7.3 is HDF5: readHdf5File().
/// @throws InputError: not such a file, damaged.
MatFile readMatFile(const std::string& file);

}  // namespace wems
