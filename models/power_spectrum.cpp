#include "models/power_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "models/breakpoints.hpp"
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
