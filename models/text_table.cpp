#include "models/text_table.hpp"

#include <algorithm>

namespace wems {
namespace {

/// Characters on the screen, not bytes: continuation bytes of UTF-8 do not count.
std::size_t displayWidth(const std::string& text) {
    return static_cast<std::size_t>(std::count_if(
        text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

}  // namespace

std::string Table::format() const {
    std::vector<std::size_t> widths;
    for (const auto& title : header_) widths.push_back(displayWidth(title));
    for (const auto& row : rows_) {
        for (std::size_t i = 0; i < row.size() && i < widths.size(); ++i)
            widths[i] = std::max(widths[i], displayWidth(row[i]));
    }
    std::string text;
    const auto addLine = [&](const std::vector<std::string>& row) {
        std::string line;
        for (std::size_t i = 0; i < row.size() && i < widths.size(); ++i) {
            const std::string padding(widths[i] - displayWidth(row[i]), ' ');
            if (i > 0) line += "  ";
            line += i == 0 ? row[i] + padding : padding + row[i];
        }
        text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    };
    addLine(header_);
    std::vector<std::string> rule;
    for (const auto width : widths) rule.emplace_back(width, '-');
    addLine(rule);
    for (const auto& row : rows_) addLine(row);
    return text;
}

}  // namespace wems
