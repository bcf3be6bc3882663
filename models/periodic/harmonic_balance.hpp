/// @file
/// Harmonic balance with alternating frequency and time: periodic motion as a Fourier series whose coefficients satisfy
/// the equations of motion in the mean over a period with each of its functions.
///
/// Unknown are the displacements of the axes with nonlinear laws alone, q_a = c_0 + Σ_k (c_k cos kωt + s_k sin kωt);
/// the linear rest follows exactly from the dynamic stiffness D(kω): with complex coefficients Q_k = c_k − i s_k
///
///     R = Q_k + G_k N_k(Q) − E_k = 0,    G_k = J D(kω)⁻¹ Jᵀ,   E_1 = J D(ω)⁻¹ B,   E_k = 0 otherwise,
///
/// N the coefficients of the nonlinear forces along q, computed at equally spaced times of a period, and their
/// derivatives likewise. Source: Cameron, Griffin (1989), doi:10.1115/1.3176036; Krack, Gross, Harmonic Balance for
/// Nonlinear Vibration Problems (2019), doi:10.1007/978-3-030-14023-6.
#pragma once

#include <Eigen/Core>

#include "models/periodic/periodic_system.hpp"

namespace wems {

/// Coefficients stand axis by axis: c_0, c_1 … c_H, s_1 … s_H, m.
class HarmonicBalance {
public:
    /// @param harmonics H, above 0
    HarmonicBalance(const PeriodicSystem& system, int harmonics);

    const PeriodicSystem& system() const { return system_; }
    Eigen::Index unknowns() const { return axes_ * coefficients_; }
    Eigen::Index coefficients() const { return coefficients_; }  ///< of one axis, 2H + 1
    Eigen::Index samples() const { return basis_.rows(); }       ///< times in a period
    /// Half of the time between two of them, s.
    double halfCell(double frequency) const { return 0.5 / (frequency * static_cast<double>(samples())); }

    /// G_k and E_1 at one frequency.
    struct Linear {
        double frequency = 0;                    ///< Hz
        std::vector<Eigen::MatrixXcd> flexible;  ///< G_0 … G_H
        Eigen::VectorXcd excited;                ///< E_1
    };
    Linear calcLinear(double frequency) const;

    /// Nonlinear forces along a motion: coefficients N, and of each axis ∂N/∂Q (empty where the law adds nothing).
    struct Nonlinear {
        Eigen::VectorXd force;
        std::vector<Eigen::MatrixXd> slope;
    };
    Nonlinear calcNonlinear(const Eigen::VectorXd& Q, double frequency) const;

    /// R, m.
    Eigen::VectorXd calcResidual(const Linear& linear, const Nonlinear& nonlinear, const Eigen::VectorXd& Q) const;
    /// G times a vector of coefficients.
    Eigen::VectorXd applyFlexibility(const Linear& linear, const Eigen::VectorXd& N) const;
    /// Rows of all axes, columns of axis `axis`: G (∂N/∂Q).
    Eigen::MatrixXd calcSlopeColumns(const Linear& linear, const Nonlinear& nonlinear, Eigen::Index axis) const;
    /// The response without nonlinear forces.
    Eigen::VectorXd calcLinearMotion(const Linear& linear) const;

    /// x of LinearSystem as complex coefficients, columns k = 0 … H.
    Eigen::MatrixXcd calcMotion(const Eigen::VectorXd& Q, double frequency) const;

    /// q and q' of one axis at equally spaced times of a period, from `shift` times their spacing on.
    struct History {
        Eigen::VectorXd q, v;
    };
    History calcHistory(const Eigen::VectorXd& Q, double frequency, Eigen::Index axis, double shift = 0) const;

private:
    const PeriodicSystem& system_;
    int harmonics_;
    Eigen::Index axes_, coefficients_;
    Eigen::MatrixXd basis_, slope_basis_;  // samples x coefficients: functions and their derivatives by ωt
    Eigen::MatrixXd projection_;           // coefficients x samples
};

}  // namespace wems
