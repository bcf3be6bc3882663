/// @file
/// The device under a harmonic input: the linear model about rest, exact in frequency, and the axes whose laws are not
/// linear. Kinematics are those of small motions about rest; the laws are complete.
///
///     M x'' + C x' + K x + Maxwell branches + Σ_a J_aᵀ n_a(q_a, q_a') = B cos-amplitude · cos ωt,    q_a = J_a x
///
/// n_a is what the law of axis a adds to its linear part at rest: stops, cubic term, friction.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/linear_response.hpp"

namespace wems {

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

}  // namespace wems
