#include "models/power_spectrum.hpp"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "models/error.hpp"
#include "models/format_number.hpp"
#include "models/recording/text_file.hpp"

namespace wems {
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

std::string_view trim(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r\"");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\r\"") - first + 1);
}

/// Two cells, separated by the first of comma, semicolon, tab, or blanks.
std::pair<std::string_view, std::string_view> splitPair(std::string_view line) {
    for (const char* separator : {",", ";", "\t", " "}) {
        const auto at = line.find(separator);
        if (at != std::string_view::npos) return {trim(line.substr(0, at)), trim(line.substr(at + 1))};
    }
    return {line, {}};
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
    : frequency_(std::move(frequency)), density_(std::move(density)), quantity_(quantity) {
    if (frequency_.size() < 2 || frequency_.size() != density_.size())
        throw InputError({{}, 0, "psd"}, "has fewer than two breakpoints", "a row `frequency,density` for each");
    for (std::size_t i = 0; i < frequency_.size(); ++i) {
        if (!(std::isfinite(frequency_[i]) && frequency_[i] > 0))
            throw InputError({{}, 0, "frequency"}, "is " + formatNumber(frequency_[i]), "Hz, above 0");
        if (!(std::isfinite(density_[i]) && density_[i] > 0))
            throw InputError({{}, 0, "psd"}, "is " + formatNumber(density_[i]), "above 0");
        if (i > 0 && !(frequency_[i] > frequency_[i - 1]))
            throw InputError({{}, 0, "frequency"},
                             formatNumber(frequency_[i]) + " Hz follow " + formatNumber(frequency_[i - 1]) + " Hz",
                             "ascending frequencies");
    }
}

double PowerSpectrum::calcValue(double frequency) const {
    if (!(frequency >= lowest() && frequency <= highest())) return 0;
    const auto next = std::upper_bound(frequency_.begin() + 1, frequency_.end() - 1, frequency);
    const auto i = static_cast<std::size_t>(next - frequency_.begin());
    const double slope = std::log(density_[i] / density_[i - 1]) / std::log(frequency_[i] / frequency_[i - 1]);
    return density_[i - 1] * std::pow(frequency / frequency_[i - 1], slope);
}

double PowerSpectrum::calcMeanSquare(double from, double to) const {
    double sum = 0;
    for (std::size_t i = 1; i < frequency_.size(); ++i) {
        const double a = std::max(from, frequency_[i - 1]), b = std::min(to, frequency_[i]);
        if (!(b > a)) continue;
        const double slope = std::log(density_[i] / density_[i - 1]) / std::log(frequency_[i] / frequency_[i - 1]);
        sum += integratePower(frequency_[i - 1], density_[i - 1], slope, a, b);
    }
    return sum;
}

double PowerSpectrum::calcRms() const {
    return std::sqrt(calcMeanSquare(lowest(), highest()));
}

PowerSpectrum parsePowerSpectrum(std::string_view text, const std::string& file) {
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (text.substr(0, byte_order_mark.size()) == byte_order_mark) text.remove_prefix(byte_order_mark.size());
    DensityUnit unit = findDensityUnit({}, {file, 0, {}});
    std::vector<double> frequency, density;
    bool header_allowed = true;
    for (long line_number = 1; !text.empty(); ++line_number) {
        const auto end = text.find('\n');
        const std::string_view line = trim(text.substr(0, end));
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        if (line.empty() || line.front() == '#') continue;
        const auto [left, right] = splitPair(line);
        const auto f = findNumber(left), s = findNumber(right);
        if (!f && !s && header_allowed) {
            const std::string hertz = findUnit(left);
            if (!hertz.empty() && hertz != "Hz")
                throw InputError({file, line_number, "frequency"}, "'" + hertz + "' is not a unit of frequency", "Hz");
            unit = findDensityUnit(findUnit(right), {file, line_number, "psd"});
            header_allowed = false;
            continue;
        }
        header_allowed = false;
        if (!f || !s)
            throw InputError({file, line_number, {}}, "\"" + std::string(line.substr(0, 60)) + "\" is no breakpoint",
                             "frequency in Hz and density, such as 20,0.01");
        // Checked here, where the line is known.
        if (!(std::isfinite(*f) && *f > 0 && (frequency.empty() || *f > frequency.back())))
            throw InputError({file, line_number, "frequency"}, "is " + formatNumber(*f), "Hz, above 0 and ascending");
        if (!(std::isfinite(*s) && *s > 0))
            throw InputError({file, line_number, "psd"}, "is " + formatNumber(*s),
                             "above 0, " + std::string(accepted_units));
        frequency.push_back(*f);
        density.push_back(*s * unit.factor);
    }
    if (frequency.size() < 2)
        throw InputError({file, 0, {}}, "has " + std::to_string(frequency.size()) + " breakpoints",
                         "two or more rows of frequency in Hz and density in " + std::string(accepted_units));
    return {std::move(frequency), std::move(density), unit.quantity};
}

PowerSpectrum readPowerSpectrum(const std::string& file) {
    return parsePowerSpectrum(TextFile(file).view(), file);
}

}  // namespace wems
