/// @file
/// A text line by line, and the fields of a line: what the readers of text formats other than CSV share.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace wems {

/// Walks over the lines of a text; LF or CRLF.
class LineCursor {
public:
    explicit LineCursor(std::string_view text, long line = 0) : rest_(text), line_(line) {}

    bool atEnd() const { return rest_.empty(); }
    /// The next line without its end.
    std::string_view take();
    /// Number of the line that was taken last, from 1.
    long line() const { return line_; }
    std::string_view rest() const { return rest_; }
    /// Moves on over `bytes` bytes that are no lines.
    void skip(std::size_t bytes) { rest_.remove_prefix(bytes < rest_.size() ? bytes : rest_.size()); }

private:
    std::string_view rest_;
    long line_;
};

/// Fields separated by tabs, which may be empty; without any tab in the line, by spaces. Outer spaces are taken off.
std::vector<std::string_view> splitFields(std::string_view line);

/// Rows of `text`, from its first megabyte.
double estimateRows(std::string_view text);

/// Rows of numbers up to the end of the text into columns; an empty field or `nan` becomes NaN. A field may hold
/// several numbers separated by commas, as OpenSim writes vectors.
/// @param columns how many numbers there are in a row; empty fields at the end may be missing
/// @param most rows that are read; the cursor then stands at the next one
/// @throws InputError with file and line: not a number, a row of another length.
std::vector<std::vector<double>> readNumberRows(LineCursor& lines, std::size_t columns, const std::string& file,
                                                std::size_t most = static_cast<std::size_t>(-1));

}  // namespace wems
