#include "models/bracket_modes.hpp"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "models/error.hpp"
#include "models/format_number.hpp"
#include "models/recording/text_file.hpp"

namespace wems {
namespace {

constexpr const char* required_header = "frequency [Hz],damping_ratio,ux,uy,uz,rx,ry,rz,load.ux,load.uy,load.uz";
constexpr const char* base_header = ",base.ux,base.uy,base.uz";

std::string_view trim(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string_view> splitCells(std::string_view line) {
    std::vector<std::string_view> cells;
    while (true) {
        const auto comma = line.find(',');
        cells.push_back(trim(line.substr(0, comma)));
        if (comma == std::string_view::npos) return cells;
        line.remove_prefix(comma + 1);
    }
}

/// The beginning of a text, for a message.
std::string quote(std::string_view text) {
    constexpr std::size_t longest = 60;
    return "\"" + std::string(text.substr(0, longest)) + (text.size() > longest ? "…\"" : "\"");
}

double parseNumber(std::string_view cell, const InputLocation& location) {
    if (cell.empty()) throw InputError(location, "the cell is empty", "a number with a decimal point");
    const bool plus = cell.front() == '+' && cell.substr(0, 2) != "+-";  // from_chars knows no plus sign
    const std::string_view digits = cell.substr(plus ? 1 : 0);
    double value = 0;
    const auto [end, error] = fast_float::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value)) {
        throw InputError(location, "is " + quote(cell), "a finite number with a decimal point");
    }
    return value;
}

BracketMode makeMode(const std::vector<double>& values) {
    BracketMode mode;
    mode.frequency = values[0];
    mode.damping_ratio = values[1];
    mode.translation = {values[2], values[3], values[4]};
    mode.rotation = {values[5], values[6], values[7]};
    mode.load_translation = {values[8], values[9], values[10]};
    if (values.size() > 11) mode.base_participation = {values[11], values[12], values[13]};
    return mode;
}

}  // namespace

std::vector<BracketMode> parseBracketModes(std::string_view text, const std::string& file) {
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (text.substr(0, byte_order_mark.size()) == byte_order_mark) text.remove_prefix(byte_order_mark.size());

    const std::string accepted_header = std::string(required_header) + ", optionally followed by " + base_header;
    const std::vector<std::string_view> required = splitCells(required_header);
    std::vector<std::string_view> columns = required;
    for (const std::string_view name : splitCells(base_header + 1)) columns.push_back(name);

    std::vector<std::string_view> header;
    std::vector<BracketMode> modes;
    for (long line_number = 1; !text.empty(); ++line_number) {
        const auto end = text.find('\n');
        const std::string_view line = trim(text.substr(0, end));
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        if (line.empty() || line.front() == '#') continue;
        const std::vector<std::string_view> cells = splitCells(line);
        if (header.empty()) {
            const bool known = cells == required || cells == columns;
            if (!known) throw InputError({file, line_number, "header"}, "is " + quote(line), accepted_header);
            header = cells;
            continue;
        }
        if (cells.size() != header.size()) {
            throw InputError({file, line_number, {}}, "has " + std::to_string(cells.size()) + " cells",
                             std::to_string(header.size()) + " as in the header");
        }
        std::vector<double> values;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const InputLocation location{file, line_number, std::string(header[i])};
            values.push_back(parseNumber(cells[i], location));
            if (i == 0 && !(values[i] > 0)) throw InputError(location, "is " + std::string(cells[i]), "above 0");
            if (i == 1 && !(values[i] >= 0)) throw InputError(location, "is " + std::string(cells[i]), "from 0 on");
        }
        modes.push_back(makeMode(values));
    }
    if (header.empty()) throw InputError({file, 0, "header"}, "is missing", accepted_header);
    if (modes.empty()) throw InputError({file, 0, {}}, "has no modes", "a row for each mode below the header");
    return modes;
}

std::string formatBracketModes(const std::vector<BracketMode>& modes) {
    const bool with_base = std::any_of(modes.begin(), modes.end(),
                                       [](const BracketMode& mode) { return !mode.base_participation.isZero(0); });
    std::string text = std::string(required_header) + (with_base ? base_header : "") + "\n";
    for (const BracketMode& mode : modes) {
        text += formatNumber(mode.frequency) + "," + formatNumber(mode.damping_ratio);
        const auto append = [&text](const Eigen::Vector3d& shape) {
            for (const double value : shape) text += "," + formatNumber(value);
        };
        append(mode.translation);
        append(mode.rotation);
        append(mode.load_translation);
        if (with_base) append(mode.base_participation);
        text += "\n";
    }
    return text;
}

std::vector<BracketMode> readBracketModes(const std::string& file) {
    return parseBracketModes(TextFile(file).view(), file);
}

}  // namespace wems
