/// @file
/// One dataset 58 of a universal file.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "models/recording/line_cursor.hpp"

namespace wems {

/// The numbers as the file writes them: fields of fixed width, by the columns of the format.
struct UffFunction {
    std::string id;              ///< first ID line
    int function_type = 0;       ///< 1: time response
    std::string entity;          ///< response entity; empty for NONE
    long node = 0;               ///< response
    int direction = 0;           ///< response: ±1 … ±3 translation x, y, z; ±4 … ±6 rotation; 0 scalar
    int abscissa_kind = 0;       ///< 17: time, 18: frequency
    int ordinate_kind = 0;       ///< 8 displacement, 11 velocity, 12 acceleration, 9 and 13 force
    std::string unit;            ///< ordinate's unit label; empty for NONE
    std::string abscissa_unit;   ///< likewise
    double start = 0, step = 0;  ///< abscissa of even spacing
    bool even = true;
    bool complex = false;
    bool double_precision = false;
    std::size_t points = 0;        ///< that the header states
    std::vector<double> abscissa;  ///< of uneven spacing
    std::vector<double> values;

    bool isTimeResponse() const;
    /// `12:+Z`
    std::string name() const;
    /// `acceleration`, from the ordinate's kind
    std::string kind() const;
    /// Abscissa of a point. The header gives an even step to six digits only: where a whole number of points per unit
    /// rounds to the same digits, that is taken.
    double time(std::size_t point) const;
};

/// How the numbers of a dataset are stored, from the line with its number.
struct UffStorage {
    bool binary = false;
    bool big_endian = false;
    int floating_format = 2;  ///< 2: IEEE 754
    long bytes = 0;           ///< of the binary part
};

/// Where the numbers of a dataset stand.
struct UffExtent {
    UffStorage storage;
    LineCursor numbers{{}};  ///< at their first line
    std::string_view bytes;  ///< of a binary dataset
};

/// Reads from the line after the dataset's number; `lines` is left at the first number of an ASCII dataset, behind the
/// last one of a binary dataset.
/// @throws InputError with file and line
UffFunction readUffHeader(LineCursor& lines, const UffStorage& storage, const std::string& file, UffExtent& extent);

/// Reads from the line after the dataset's number up to the end of its numbers; the closing `-1` is left. Of what is no
/// time response the numbers are not read.
/// @throws InputError with file and line
UffFunction readUffFunction(LineCursor& lines, const UffStorage& storage, const std::string& file);

/// Characters `from` to `from + width` of `line` without outer spaces; empty beyond its end.
std::string_view uffField(std::string_view line, std::size_t from, std::size_t width);
/// The whole number in such a field; 0 if it is empty.
/// @throws InputError
long uffInteger(std::string_view line, std::size_t from, std::size_t width, const std::string& file, long line_number);

// The numbers of a dataset 58.

/// A number as Fortran writes it: exponents with E, D, or no letter at all (1.0-100). False if it is none.
bool parseUffReal(std::string_view text, double& value);

/// Reads the numbers front to back, all at once or some at a time.
///
/// - ASCII: E13.5 for single, E20.12 for double precision; the abscissa of uneven spacing always E13.5. Six single or
///   four double numbers to a line, three pairs of single precision, two pairs of mixed width.
/// - Binary: the same, 4 bytes for single and 8 for double precision, the abscissa 4. Some programs write all numbers
///   in one width whatever the header says; the length tells.
class UffNumberReader {
public:
    /// @param shape its header
    /// @param file must outlive the reader
    UffNumberReader(const UffFunction& shape, const UffExtent& extent, const std::string& file);

    /// Appends values (and abscissas) to `function` until `points` have been read since the beginning, or a few more,
    /// but never more than there are.
    /// @throws InputError with file and line
    void read(std::size_t points, UffFunction& function);
    /// Behind the last line that was read.
    const LineCursor& cursor() const { return lines_; }

private:
    std::size_t perPoint() const { return ordinates_ + (with_abscissa_ ? 1 : 0); }
    bool isAbscissa() const { return with_abscissa_ && read_ % perPoint() == 0; }
    void readLine(UffFunction& function);
    void readBinary(std::size_t until, UffFunction& function);
    void take(double value, UffFunction& function);

    const std::string& file_;
    LineCursor lines_;
    std::string_view bytes_;
    bool binary_, big_endian_, double_precision_, with_abscissa_;
    std::size_t ordinates_;                  // 2 for complex numbers
    std::size_t count_, read_ = 0, at_ = 0;  // numbers, and bytes of the binary ones
};

}  // namespace wems
