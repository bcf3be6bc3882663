/// @file
/// A power spectral density given by breakpoints, as test specifications write it.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "models/common/error.hpp"
#include "models/common/units.hpp"

namespace wems {

// Rows of test specifications: breakpoints over frequency, as tables in text.

/// One row of a table in text: cells between commas, semicolons, tabs or blanks, whichever occurs first in this order.
struct TextRow {
    long line = 0;  ///< from 1
    std::string_view text;
    std::vector<std::string_view> cells;  ///< without blanks and quotes around them
};

/// Rows that are neither empty nor a comment, which `#` begins. The cells point into `text`.
std::vector<TextRow> splitTextRows(std::string_view text);

/// Frequencies (Hz, ascending) and what a specification demands there, straight lines in log–log between.
struct Breakpoints {
    std::vector<double> frequency, value;

    /// 0 outside.
    double calcValue(double at) const;
};

/// What the second column of a file of breakpoints is.
struct BreakpointColumn {
    const char* name;   ///< in messages
    const char* units;  ///< accepted, in messages
    /// Factor to SI of the unit in the header; of an empty one where the header names none or there is no header.
    /// @throws InputError
    std::function<double(const std::string& unit, const InputLocation&)> findFactor;
};

/// Two columns, frequency in Hz and a value; a header is optional. @throws InputError with file and line
Breakpoints parseBreakpoints(std::string_view text, const std::string& file, const BreakpointColumn& column);

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
