/// @file
/// Response of the linear model to a stationary random excitation, from its transfer functions: S_out = |H|² S_in.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/linear_response.hpp"
#include "models/power_spectrum.hpp"

namespace wems {

/// Rows of every matrix below: 12 for each connection, in the order relative x y z (m), force x y z (N), acceleration
/// of the mobile end x y z, of the fixed end x y z (m/s²).
constexpr Eigen::Index kOutputsPerConnection = 12;

/// The complex amplitudes in that order.
Eigen::VectorXcd listOutputs(const std::vector<ConnectionResponse>& response);

struct RandomResponse {
    std::vector<double> frequency;  ///< Hz
    Eigen::MatrixXd density;        ///< outputs x frequencies, unit²/Hz
    Eigen::VectorXd rms;            ///< of each output, over the whole spectrum
    Eigen::VectorXd rate;           ///< Hz, of upward zero crossings: √(∫ f² S df / ∫ S df)
};

/// @param direction load or base of size 1 that the spectrum multiplies
/// @param frequency Hz, where the densities are wanted
/// RMS and rate by adaptive Gauss–Legendre quadrature in log f, panels halved until every output's mean square is known
/// to 1e-9.
RandomResponse calcRandomResponse(const LinearDynamics& dynamics, const HarmonicInput& direction,
                                  const PowerSpectrum& spectrum, const std::vector<double>& frequency);

}  // namespace wems
