/// @file
/// Harmonic response of the linear model about its static equilibrium, exact at every frequency: Maxwell branches and
/// structural damping enter as the complex stiffness g iωτ/(1 + iωτ).
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "models/linear_modes.hpp"
#include "models/power_spectrum.hpp"

namespace wems {

/// Complex amplitudes at one connection; q(t) = Re(relative exp(iωt)).
struct ConnectionResponse {
    Eigen::Vector3cd relative;             ///< m, F axes
    Eigen::Vector3cd force;                ///< N, F axes, sign of q: what elastomer and dashpot carry beyond rest
    Eigen::Vector3cd mobile_acceleration;  ///< m/s², absolute, G axes
    Eigen::Vector3cd fixed_acceleration;   ///< m/s², absolute, G axes
};

/// What drives the model: amplitudes of the load (N) and of the base acceleration (m/s²), G axes.
struct HarmonicInput {
    Eigen::Vector3d load = Eigen::Vector3d::Zero();
    Eigen::Vector3d base = Eigen::Vector3d::Zero();
};

/// K + iωC − ω²M + Σ_b Jᵀ g iωτ/(1 + iωτ) J. @param system of linearizeExactly() @param omega rad/s
Eigen::MatrixXcd calcDynamicStiffness(const LinearSystem& system, double omega);

class LinearDynamics {
public:
    /// @throws InputError if the model has no static equilibrium.
    explicit LinearDynamics(const MountModel& model);

    const LinearSystem& system() const { return system_; }

    /// x of LinearSystem, complex amplitudes. @param frequency Hz, above 0
    Eigen::VectorXcd calcMotion(double frequency, const HarmonicInput& input) const;
    /// One for each connection.
    std::vector<ConnectionResponse> calcResponse(double frequency, const HarmonicInput& input) const;

private:
    LinearSystem system_;
    std::vector<Eigen::Matrix3d> stiffness_, damping_;  // of each connection, static; diagonal
};

// Response of the linear model to a stationary random excitation, from its transfer functions: S_out = |H|² S_in.

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
