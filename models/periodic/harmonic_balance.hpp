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
#include <vector>

#include "models/linear_response.hpp"

namespace wems {

// The device under a harmonic input: the linear model about rest, exact in frequency, and the axes whose laws are not
// linear. Kinematics are those of small motions about rest; the laws are complete.
//
//     M x'' + C x' + K x + Maxwell branches + Σ_a J_aᵀ n_a(q_a, q_a') = B cos-amplitude · cos ωt,    q_a = J_a x
//
// n_a is what the law of axis a adds to its linear part at rest: stops, cubic term, friction.

/// One axis of one connection whose law is not linear.
class NonlinearAxis {
public:
    /// @param rest displacement at rest, m
    NonlinearAxis(int connection, int axis, const AxisForce& force, double rest);

    int connection() const { return connection_; }
    int axis() const { return axis_; }

    struct Value {
        double force, stiffness, damping;  ///< n (N), ∂n/∂q (N/m), ∂n/∂q' (N s/m)
    };
    /// The law in the mean over the times from `half` before to `half` after, at which q changes with v: so that what
    /// is computed from samples is a smooth function of the motion, also where a sample begins to touch a stop. With w
    /// = |v| half and δ the penetration at the middle, a stop's max(0, δ) becomes (δ + w)²/4w for |δ| < w.
    /// @param q displacement from rest, m @param v m/s @param half s
    Value calcValue(double q, double v, double half) const;

private:
    int connection_, axis_;
    AxisForce force_;
    double rest_, rest_force_, stiffness_, damping_, branches_ = 0;
};

class PeriodicSystem {
public:
    /// @throws InputError if the model has no static equilibrium, or friction with presliding or hysteresis, whose
    /// force depends on its whole history
    PeriodicSystem(const MountModel& model, const HarmonicInput& input);

    const MountModel& model() const { return model_; }
    const LinearSystem& linear() const { return linear_; }
    const std::vector<NonlinearAxis>& axes() const { return axes_; }
    /// J: rows as axes().
    const Eigen::MatrixXd& rows() const { return rows_; }
    /// Generalized force amplitude at a frequency (Hz), the model's load gain applied.
    Eigen::VectorXd calcForce(double frequency) const;
    /// Displacement at rest of each connection, F axes, m.
    const Eigen::Matrix3Xd& rest() const { return rest_; }

private:
    MountModel model_;
    HarmonicInput input_;
    LinearSystem linear_;
    std::vector<NonlinearAxis> axes_;
    Eigen::MatrixXd rows_;
    Eigen::Matrix3Xd rest_;
};

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

    /// q and q' of one axis half way between the samples.
    struct History {
        Eigen::VectorXd q, v;
    };
    History calcMiddleHistory(const Eigen::VectorXd& Q, double frequency, Eigen::Index axis) const;

private:
    /// Coefficients of each function of the series times a factor that is given at the samples: sums and differences of
    /// the factor's own coefficients up to 2H.
    Eigen::MatrixXd projectProduct(const Eigen::VectorXd& factor) const;

    const PeriodicSystem& system_;
    int harmonics_;
    Eigen::Index axes_, coefficients_;
    Eigen::MatrixXd basis_, slope_basis_;  // samples x coefficients: functions and their derivatives by ωt
    Eigen::MatrixXd middle_basis_, middle_slope_basis_;  // the same half way between the samples
    Eigen::MatrixXd projection_;                         // coefficients x samples
    Eigen::MatrixXd moments_;                            // means over the samples with 1, cos, sin up to 2H
};

// Stability of a periodic motion: the Floquet multipliers of the equations of motion linearised along it.

/// Eigenvalues of the map of a small disturbance of (x, x', internal states) over one period; the motion is stable if
/// all lie within the unit circle. Largest first. They are exp(2π α/ω) of Hill's exponents α.
///
/// The disturbance obeys M y'' + (C + Σ J_aᵀ ∂n/∂q' J_a) y' + (K + Σ J_aᵀ ∂n/∂q J_a) y + branches = 0, integrated by
/// the implicit midpoint rule over the samples of the balance; a mode of frequency f then turns by (2π f/(f₀ N))²/12 of
/// its angle too little, f₀ the motion's frequency and N the samples.
Eigen::VectorXcd calcFloquetMultipliers(const HarmonicBalance& balance, const Eigen::VectorXd& Q, double frequency);

/// Where the largest multiplier lies outside of the unit circle: beyond +1 (between two folds, or where a symmetric
/// motion has lost its symmetry), beyond −1 (the period doubles), elsewhere (a second frequency appears:
/// quasi-periodic).
enum class Instability { none, real, period_doubling, neimark_sacker };
Instability findInstability(const Eigen::VectorXcd& multipliers);

}  // namespace wems
