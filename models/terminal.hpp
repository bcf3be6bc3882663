/// @file
/// How text looks on a terminal.
#pragma once

#include <string>

namespace wems {

enum class TextStyle { plain, coloured };

/// Coloured if the file descriptor is a terminal that knows colours, unless the environment variable NO_COLOR is set
/// and not empty (no-color.org) or TERM is `dumb`.
TextStyle styleOf(int file_descriptor);

enum class Colour { bold, dim, cyan, green, yellow };

/// The text in a colour; as it is in the plain style.
std::string paint(const std::string& text, Colour colour, TextStyle style);

}  // namespace wems
