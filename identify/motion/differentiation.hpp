/// @file
/// Velocity and acceleration from displacements: zero-phase smoothing and central differences.
#pragma once

#include <Eigen/Core>

namespace wems::identify {

/// Zero-phase low pass: a third-order Butterworth filter forward and backward, gain 1/(1 + (f/cutoff)⁶) (1/2 at the
/// cutoff, 0.985 at half of it). The ends are continued by point reflection.
/// @param cutoff Hz, at most 0.45 of the sampling rate
Eigen::VectorXd smoothZeroPhase(const Eigen::VectorXd& signal, double interval, double cutoff);

struct Derivatives {
    Eigen::VectorXd first, second;
};

/// Central differences of eighth order, of lower order at the last four samples of each end.
Derivatives differentiate(const Eigen::VectorXd& signal, double interval);

/// Frequency (Hz) up to which the signals (rows) stand out of their white noise floor, at most 0.25 of the sampling
/// rate: the cutoff for smoothZeroPhase.
double findCutoff(const Eigen::MatrixXd& signals, double interval);

}  // namespace wems::identify
