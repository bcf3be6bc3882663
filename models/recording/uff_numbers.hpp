/// @file
/// The numbers of a dataset 58.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "models/recording/uff_function.hpp"

namespace wems {

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
