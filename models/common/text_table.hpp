/// @file
/// Tables on a terminal.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace wems {

// How text looks on a terminal.

enum class TextStyle { plain, coloured };

/// Coloured if the file descriptor is a terminal that knows colours, unless the environment variable NO_COLOR is set
/// and not empty (no-color.org) or TERM is `dumb`.
TextStyle styleOf(int file_descriptor);

enum class Colour { bold, dim, cyan, green, yellow };

/// The text in a colour; as it is in the plain style.
std::string paint(const std::string& text, Colour colour, TextStyle style);

/// A table with right-aligned columns but the first.
class Table {
public:
    explicit Table(std::vector<std::string> header) : header_(std::move(header)) {}
    void addRow(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
    /// Columns aligned with blanks; coloured: header bold, rule dim, first column cyan.
    std::string format(TextStyle style = TextStyle::plain) const;
    bool empty() const { return rows_.empty(); }

    const std::vector<std::string>& header() const { return header_; }
    const std::vector<std::vector<std::string>>& rows() const { return rows_; }

private:
    std::vector<std::string> header_;
    std::vector<std::vector<std::string>> rows_;
};

}  // namespace wems
