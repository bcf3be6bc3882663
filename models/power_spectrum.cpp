#include "models/power_spectrum.hpp"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/common/text_file.hpp"

namespace wems {

namespace {

constexpr std::string_view kOuter = " \t\r\"";  // of a cell

/// By the first of these that the line has; spaces may be several.
std::vector<std::string_view> splitLine(std::string_view line) {
    for (const char separator : {',', ';', '\t', ' '}) {
        if (line.find(separator) == std::string_view::npos) continue;
        std::vector<std::string_view> cells = splitCells(line, separator, kOuter);
        if (separator == ' ')
            cells.erase(std::remove_if(cells.begin(), cells.end(), [](const auto& cell) { return cell.empty(); }),
                        cells.end());
        return cells;
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
        const std::string_view line = trim(text.substr(0, end), kOuter);
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        if (!line.empty() && line.front() != '#') rows.push_back({line_number, line, splitLine(line)});
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

namespace {

constexpr const char* accepted_units = "g^2/Hz, (m/s^2)^2/Hz, N^2/Hz";

/// ∫ S df of S = s0 (f/f0)^n from a to b.
double integratePower(double f0, double s0, double n, double a, double b) {
    // ∫ f^n df = f (f^n − …)/(n + 1); with log for n near −1, where both differ by less than rounding loses.
    const double exponent = n + 1, log_ratio = std::log(b / a);
    const double growth = std::abs(exponent * log_ratio) < 1e-8 ? log_ratio * (1 + 0.5 * exponent * log_ratio)
                                                                : std::expm1(exponent * log_ratio) / exponent;
    return s0 * std::pow(a / f0, n) * a * growth;
}

struct DensityUnit {
    Quantity quantity;
    double factor;
};

DensityUnit findDensityUnit(const std::string& unit, const InputLocation& location) {
    constexpr double g = 9.80665;
    if (unit.empty() || unit == "g^2/Hz" || unit == "G^2/Hz") return {Quantity::acceleration, g * g};
    if (unit == "(m/s^2)^2/Hz" || unit == "m^2/s^4/Hz" || unit == "m^2/s^3") return {Quantity::acceleration, 1};
    if (unit == "N^2/Hz") return {Quantity::force, 1};
    throw InputError(location, "'" + unit + "' is not a unit of a power spectral density", accepted_units);
}

}  // namespace

PowerSpectrum::PowerSpectrum(std::vector<double> frequency, std::vector<double> density, Quantity quantity)
    : points_{std::move(frequency), std::move(density)}, quantity_(quantity) {
    if (points_.frequency.size() < 2 || points_.frequency.size() != points_.value.size())
        throw InputError({{}, 0, "psd"}, "has fewer than two breakpoints", "a row `frequency,density` for each");
    for (std::size_t i = 0; i < points_.frequency.size(); ++i) {
        if (!(std::isfinite(points_.frequency[i]) && points_.frequency[i] > 0))
            throw InputError({{}, 0, "frequency"}, "is " + formatNumber(points_.frequency[i]), "Hz, above 0");
        if (!(std::isfinite(points_.value[i]) && points_.value[i] > 0))
            throw InputError({{}, 0, "psd"}, "is " + formatNumber(points_.value[i]), "above 0");
        if (i > 0 && !(points_.frequency[i] > points_.frequency[i - 1]))
            throw InputError(
                {{}, 0, "frequency"},
                formatNumber(points_.frequency[i]) + " Hz follow " + formatNumber(points_.frequency[i - 1]) + " Hz",
                "ascending frequencies");
    }
}

double PowerSpectrum::calcValue(double frequency) const {
    return points_.calcValue(frequency);
}

double PowerSpectrum::calcMeanSquare(double from, double to) const {
    double sum = 0;
    for (std::size_t i = 1; i < points_.frequency.size(); ++i) {
        const double a = std::max(from, points_.frequency[i - 1]), b = std::min(to, points_.frequency[i]);
        if (!(b > a)) continue;
        const double slope = std::log(points_.value[i] / points_.value[i - 1]) /
                             std::log(points_.frequency[i] / points_.frequency[i - 1]);
        sum += integratePower(points_.frequency[i - 1], points_.value[i - 1], slope, a, b);
    }
    return sum;
}

double PowerSpectrum::calcRms() const {
    return std::sqrt(calcMeanSquare(lowest(), highest()));
}

PowerSpectrum parsePowerSpectrum(std::string_view text, const std::string& file) {
    Quantity quantity = Quantity::acceleration;
    const BreakpointColumn column{"psd", accepted_units, [&](const std::string& unit, const InputLocation& location) {
                                      const DensityUnit found = findDensityUnit(unit, location);
                                      quantity = found.quantity;
                                      return found.factor;
                                  }};
    Breakpoints points = parseBreakpoints(text, file, column);
    return {std::move(points.frequency), std::move(points.value), quantity};
}

PowerSpectrum readPowerSpectrum(const std::string& file) {
    return parsePowerSpectrum(TextFile(file).view(), file);
}

}  // namespace wems
