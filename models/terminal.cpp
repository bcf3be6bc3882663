#include "models/terminal.hpp"

#include <unistd.h>

#include <cstdlib>

namespace wems {

TextStyle styleOf(int file_descriptor) {
    const char* const no_color = std::getenv("NO_COLOR");
    const char* const terminal = std::getenv("TERM");
    const bool refused = no_color != nullptr && *no_color != '\0';
    const bool dumb = terminal == nullptr || std::string(terminal) == "dumb";
    return isatty(file_descriptor) != 0 && !refused && !dumb ? TextStyle::coloured : TextStyle::plain;
}

std::string paint(const std::string& text, Colour colour, TextStyle style) {
    if (style == TextStyle::plain || text.empty()) return text;
    const char* code = "1";
    switch (colour) {
        case Colour::bold:
            break;
        case Colour::dim:
            code = "2";
            break;
        case Colour::cyan:
            code = "36";
            break;
        case Colour::green:
            code = "1;32";
            break;
        case Colour::yellow:
            code = "33";
            break;
    }
    return std::string("\033[") + code + "m" + text + "\033[0m";
}

}  // namespace wems
