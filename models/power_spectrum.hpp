/// @file
/// A power spectral density given by breakpoints, as test specifications write it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "models/breakpoints.hpp"
#include "models/units.hpp"

namespace wems {

/// Straight lines in log–log between the breakpoints, S(f) = S₀ (f/f₀)^n; zero below the first and above the last.
/// One-sided: the mean square is ∫ S df.
class PowerSpectrum {
public:
    /// @param frequency Hz, ascending, above 0, at least two
    /// @param density   unit²/Hz, above 0; SI
    /// @throws InputError
    PowerSpectrum(std::vector<double> frequency, std::vector<double> density, Quantity quantity);

    double lowest() const { return points_.frequency.front(); }  ///< Hz
    double highest() const { return points_.frequency.back(); }  ///< Hz
    Quantity quantity() const { return quantity_; }              ///< acceleration (m/s²)²/Hz or force N²/Hz
    const std::vector<double>& frequency() const { return points_.frequency; }
    const std::vector<double>& density() const { return points_.value; }

    /// unit²/Hz
    double calcValue(double frequency) const;
    /// ∫ S df over the part of [from, to] that the spectrum covers, in closed form.
    double calcMeanSquare(double from, double to) const;
    double calcRms() const;

private:
    Breakpoints points_;
    Quantity quantity_;
};

/// Reads breakpoints: two columns, frequency and density, separated by comma, semicolon, tab or blanks; `#` begins a
/// comment. A header is optional; without one, or without units, Hz and g²/Hz. Units of the second column: g^2/Hz,
/// (m/s^2)^2/Hz, N^2/Hz. @throws InputError with file and line.
PowerSpectrum readPowerSpectrum(const std::string& file);
/// The same from text; `file` is for messages.
PowerSpectrum parsePowerSpectrum(std::string_view text, const std::string& file);

}  // namespace wems
