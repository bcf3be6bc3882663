/// @file
/// Several sines at once.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace wems::identify {

/// Frequencies (Hz, ascending) of two to twelve lines that a signal consists of and that last together; empty for
/// anything else: one sine, a sweep, steps from one frequency to the next, random.
///
/// Lines are narrow islands in the spectrum of the whole signal that hold most of its power, each at least 4 % of the
/// strongest (a fifth of its amplitude); nearer to each other than about seven over the duration they count as one.
/// Their powers over time must overlap by half.
/// @param harmonics_count false: lines at multiples of the lowest are what a part makes of one sine
/// @param highest frequency of the drive, Hz, as far as it is known
std::vector<double> findTones(const Eigen::VectorXd& signal, double interval, double highest, bool harmonics_count);

}  // namespace wems::identify
