/// @file
/// Shock response spectrum of a base acceleration.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "models/excitation.hpp"
#include "models/power_spectrum.hpp"

namespace wems {

/// For each natural frequency the largest absolute acceleration of a mass on spring and dashpot whose base moves as
/// recorded, during the record and for one period after it.
struct ShockResponse {
    std::vector<double> frequency;  ///< Hz
    Eigen::VectorXd positive;       ///< largest, m/s² (the record's unit)
    Eigen::VectorXd negative;       ///< largest of the other sign, as a positive number
    Eigen::VectorXd maximax;        ///< the larger of both
};

/// Ramp-invariant digital filter: exact for an acceleration that is linear between samples.
/// Sources: Smallwood (1981), Shock and Vibration Bulletin 51; ISO 18431-4:2007.
/// @param quality Q = 1/(2ζ), above 0.5
ShockResponse calcShockResponse(const Eigen::VectorXd& acceleration, double interval,
                                const std::vector<double>& frequency, double quality);

/// `per_octave` frequencies an octave, from `from` up to at most `to`, Hz.
std::vector<double> makeOctaves(double from, double to, int per_octave);

// A base acceleration that has a given shock response spectrum: a sum of wavelets.
//
// Wavelet m is A_m sin(2π f_m t/N_m) sin(2π f_m t) for 0 ≤ t ≤ N_m/(2 f_m), N_m odd and at least 3: velocity and
// displacement are zero at both ends, so that a shaker table comes back to where it was. The frequencies lie a sixth
// of an octave apart, neighbours with opposite signs; amplitudes are changed by what the spectrum of the sum lacks at
// each f_m until it stays. Source: Smallwood, Nord (1974), "Matching shock spectra with sums of decaying sinusoids
// compensated for shaker velocity and displacement limitations", and the wavelets of WAVSYN; Irvine (2015), "Shock
// response spectrum synthesis via wavelets".

/// Frequencies in Hz, accelerations in m/s²: of the largest of both signs (maximax). Units of the file: g, m/s^2.
/// @throws InputError with file and line
Breakpoints readShockSpectrum(const std::string& file);
Breakpoints parseShockSpectrum(std::string_view text, const std::string& file);

struct ShockSynthesis {
    std::shared_ptr<const Signal> signal;  ///< m/s²
    /// dB, of the achieved over the demanded spectrum, on a grid of twelve frequencies an octave.
    double least_decibels = 0, most_decibels = 0;
};

/// @param quality Q of the oscillators @param rest s, nothing after the wavelets
/// @throws InputError if the spectrum cannot be met within 3 dB anywhere: too steep, or too narrow a band
ShockSynthesis synthesizeShock(const Breakpoints& spectrum, double quality, double rest);

}  // namespace wems
