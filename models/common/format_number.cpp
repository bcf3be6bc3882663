#include "models/common/format_number.hpp"

#include <array>
#include <charconv>

namespace wems {

std::string formatNumber(double value) {
    std::array<char, 40> text{};
    const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
    return {text.data(), result.ptr};
}

std::string formatNumber(double value, int digits) {
    std::array<char, 400> text{};
    const auto result =
        std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, digits);
    return {text.data(), result.ptr};
}

std::string joinWords(const std::vector<std::string>& words, const std::string& separator) {
    std::string text;
    for (const auto& word : words) text += (text.empty() ? "" : separator) + word;
    return text;
}

std::string_view trim(std::string_view text, std::string_view outer) {
    const auto first = text.find_first_not_of(outer);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(outer) - first + 1);
}

std::vector<std::string_view> splitCells(std::string_view line, char separator, std::string_view outer) {
    std::vector<std::string_view> cells;
    while (true) {
        const auto end = line.find(separator);
        cells.push_back(trim(line.substr(0, end), outer));
        if (end == std::string_view::npos) return cells;
        line.remove_prefix(end + 1);
    }
}

}  // namespace wems
