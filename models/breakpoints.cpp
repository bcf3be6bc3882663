#include "models/breakpoints.hpp"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "models/format_number.hpp"

namespace wems {
namespace {

std::string_view trim(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r\"");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\r\"") - first + 1);
}

std::vector<std::string_view> splitCells(std::string_view line) {
    std::vector<std::string_view> cells;
    for (const char separator : {',', ';', '\t', ' '}) {
        if (line.find(separator) == std::string_view::npos) continue;
        while (true) {
            const auto at = line.find(separator);
            const std::string_view cell = trim(line.substr(0, at));
            if (separator != ' ' || !cell.empty()) cells.push_back(cell);
            if (at == std::string_view::npos) return cells;
            line.remove_prefix(at + 1);
        }
    }
    return {line};
}

std::optional<double> findNumber(std::string_view text) {
    double value = 0;
    const auto [end, error] = fast_float::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

/// What stands in the last brackets of a header's cell.
std::string findUnit(std::string_view cell) {
    const auto from = cell.find('['), to = cell.rfind(']');
    if (from == std::string_view::npos || to == std::string_view::npos || to < from) return {};
    std::string unit;
    for (const char c : cell.substr(from + 1, to - from - 1))
        if (c != ' ') unit += c;
    for (std::size_t at = 0; (at = unit.find("²")) != std::string::npos;)
        unit.replace(at, std::string("²").size(), "^2");
    return unit;
}

}  // namespace

std::vector<TextRow> splitTextRows(std::string_view text) {
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (text.substr(0, byte_order_mark.size()) == byte_order_mark) text.remove_prefix(byte_order_mark.size());
    std::vector<TextRow> rows;
    for (long line_number = 1; !text.empty(); ++line_number) {
        const auto end = text.find('\n');
        const std::string_view line = trim(text.substr(0, end));
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        if (!line.empty() && line.front() != '#') rows.push_back({line_number, line, splitCells(line)});
    }
    return rows;
}

double Breakpoints::calcValue(double at) const {
    if (!(at >= frequency.front() && at <= frequency.back())) return 0;
    const auto next = std::upper_bound(frequency.begin() + 1, frequency.end() - 1, at);
    const std::size_t i = next - frequency.begin();
    const double slope = std::log(value[i] / value[i - 1]) / std::log(frequency[i] / frequency[i - 1]);
    return value[i - 1] * std::pow(at / frequency[i - 1], slope);
}

Breakpoints parseBreakpoints(std::string_view text, const std::string& file, const BreakpointColumn& column) {
    double factor = column.findFactor({}, {file, 0, {}});
    Breakpoints points;
    bool header_allowed = true;
    for (const TextRow& row : splitTextRows(text)) {
        const std::string_view left = row.cells.front();
        const std::string_view right = row.cells.size() > 1 ? row.cells[1] : std::string_view();
        const auto f = findNumber(left), value = findNumber(right);
        if (!f && !value && header_allowed) {
            const std::string hertz = findUnit(left);
            if (!hertz.empty() && hertz != "Hz")
                throw InputError({file, row.line, "frequency"}, "'" + hertz + "' is not a unit of frequency", "Hz");
            factor = column.findFactor(findUnit(right), {file, row.line, column.name});
            header_allowed = false;
            continue;
        }
        header_allowed = false;
        if (!f || !value || row.cells.size() > 2)
            throw InputError({file, row.line, {}}, "\"" + std::string(row.text.substr(0, 60)) + "\" is no breakpoint",
                             std::string("frequency in Hz and ") + column.name + ", such as 20,0.01");
        if (!(std::isfinite(*f) && *f > 0 && (points.frequency.empty() || *f > points.frequency.back())))
            throw InputError({file, row.line, "frequency"}, "is " + formatNumber(*f), "Hz, above 0 and ascending");
        if (!(std::isfinite(*value) && *value > 0))
            throw InputError({file, row.line, column.name}, "is " + formatNumber(*value),
                             std::string("above 0, ") + column.units);
        points.frequency.push_back(*f);
        points.value.push_back(*value * factor);
    }
    if (points.frequency.size() < 2)
        throw InputError({file, 0, {}}, "has " + std::to_string(points.frequency.size()) + " breakpoints",
                         std::string("two or more rows of frequency in Hz and ") + column.name + " in " + column.units);
    return points;
}

}  // namespace wems
