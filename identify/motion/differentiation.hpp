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

/// Frequency (Hz) below which nine tenths of the power of the signals' second derivatives (rows together) lie, of what
/// stands out of their white noise floor; 0 where nothing does.
double findAccelerationEnd(const Eigen::MatrixXd& signals, double interval);

// Rates of a rotation vector θ, R = exp([θ]×), and angular velocity ω = B(θ) θ', in the outer frame. B is the left
// Jacobian of SO(3), B = I + c1 [θ]× + c2 [θ]×², c1 = (1 − cos θ)/θ², c2 = (θ − sin θ)/θ³.

/// ω = B θ' (rad/s).
Eigen::Vector3d calcAngularVelocity(const Eigen::Vector3d& theta, const Eigen::Vector3d& theta_dot);

/// α = B θ'' + B' θ' (rad/s²).
Eigen::Vector3d calcAngularAcceleration(const Eigen::Vector3d& theta, const Eigen::Vector3d& theta_dot,
                                        const Eigen::Vector3d& theta_dot_dot);

/// θ' from ω; |θ| < 2π.
Eigen::Vector3d calcVectorRate(const Eigen::Vector3d& theta, const Eigen::Vector3d& w);

/// θ'' from α; |θ| < 2π.
Eigen::Vector3d calcVectorAcceleration(const Eigen::Vector3d& theta, const Eigen::Vector3d& theta_dot,
                                       const Eigen::Vector3d& alpha);

}  // namespace wems::identify
