/// @file
/// The variables of a MATLAB file as a tree, without its library.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace wems {

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
    std::vector<double> numbers;        ///< column by column
    std::vector<std::string> texts;     ///< UTF-8, without blanks at the end
    std::vector<MatValue> elements;
    std::vector<std::pair<std::string, MatValue>> fields;  ///< of an element of a structure

    const MatValue* find(const std::string& field) const;
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
