/// @file
/// Shock response spectrum of a base acceleration.
#pragma once

#include <Eigen/Core>
#include <vector>

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

}  // namespace wems
