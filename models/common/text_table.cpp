#include "models/common/text_table.hpp"

#include <unistd.h>

#include <algorithm>
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

namespace {

/// Characters on the screen, not bytes: continuation bytes of UTF-8 do not count.
std::size_t displayWidth(const std::string& text) {
    return static_cast<std::size_t>(std::count_if(
        text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

}  // namespace

std::string Table::format(TextStyle style) const {
    std::vector<std::size_t> widths;
    for (const auto& title : header_) widths.push_back(displayWidth(title));
    for (const auto& row : rows_) {
        for (std::size_t i = 0; i < row.size() && i < widths.size(); ++i)
            widths[i] = std::max(widths[i], displayWidth(row[i]));
    }
    std::string text;
    const auto padded = [&](const std::vector<std::string>& row, std::size_t i) {
        const std::string padding(widths[i] - displayWidth(row[i]), ' ');
        return i == 0 ? row[i] + padding : "  " + padding + row[i];
    };
    const auto addLine = [&](const std::vector<std::string>& row, Colour first, Colour others, TextStyle other_style) {
        std::string line;
        for (std::size_t i = 1; i < row.size() && i < widths.size(); ++i) line += padded(row, i);
        line = line.substr(0, line.find_last_not_of(' ') + 1);
        std::string name = row.empty() ? "" : padded(row, 0);
        if (line.empty()) name = name.substr(0, name.find_last_not_of(' ') + 1);
        text += paint(name, first, style) + paint(line, others, other_style) + "\n";
    };
    addLine(header_, Colour::bold, Colour::bold, style);
    std::vector<std::string> rule;
    for (const auto width : widths) rule.emplace_back(width, '-');
    addLine(rule, Colour::dim, Colour::dim, style);
    for (const auto& row : rows_) addLine(row, Colour::cyan, Colour::dim, TextStyle::plain);
    return text;
}

}  // namespace wems
