/// @file
/// The mount's equation along a motion whose slow part was not measured, as with accelerations alone.
///
/// The slow motion s(t), cubic splines B with knots every 1 / (2 f_c), is what balances the slow part of the forces:
///
///     Bᵀ R = 0        (R the mount's residual, B also the weights)
///
/// It belongs to the model: a stop that lies elsewhere moves the mean of the motion. The mobile part has it where its
/// displacements are integrated accelerations, else the fixed part, the other way and without inertia (M = 0 below).
/// With K(t) the tangent stiffness and M the mass matrix of a model, whose slow motion is known, a residual R leaves to
/// first order
///
///     P R = R − K B A⁻¹ Bᵀ R,        A = Bᵀ (K B + M B̈)
///
/// once the slow motion has followed. P is linear, so that it acts on residuals, their differences and the columns of
/// calibration alike, and P K B = 0: an error of the slow motion, by noise or by the wrong model that it came from, is
/// gone to first order.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <memory>
#include <vector>

#include "identify/problem/open_loop_run.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

class SlowBalance {
public:
    /// @param model whose slow motion `run` has
    /// @param followed what `run` has taken of it from balances so far, coefficients; nothing if empty
    SlowBalance(const OpenLoopRun& run, const MountModel& model, Eigen::VectorXd followed = {});

    const Eigen::VectorXd& followed() const { return followed_; }
    /// f_c, Hz: slower motion is balanced.
    double cornerFrequency() const { return corner_; }
    /// What frequencies above this hold is not touched but for contact, Hz.
    double highestBalanced() const;

    /// A⁻¹ Bᵀ R of a residual (6 x samples): coefficients, six for each spline.
    Eigen::VectorXd solve(const Eigen::Ref<const Eigen::MatrixXd>& residual) const;
    /// A⁻¹ (Bᵀ R + H c) where a run has followed c: H holds it at 0 where the window hides all. Newton's step back.
    Eigen::VectorXd solveHeld(const Eigen::Ref<const Eigen::MatrixXd>& residual,
                              const Eigen::Ref<const Eigen::VectorXd>& followed) const;
    /// K B c: 6 x samples.
    Eigen::MatrixXd calcForces(const Eigen::Ref<const Eigen::VectorXd>& coefficients) const;
    /// P R.
    Eigen::MatrixXd balance(const Eigen::Ref<const Eigen::MatrixXd>& residual) const;
    /// B c and its first two derivatives: 6 x samples.
    Eigen::MatrixXd calcMotion(const Eigen::Ref<const Eigen::VectorXd>& coefficients, int derivative) const;

private:
    using Matrix6 = Eigen::Matrix<double, 6, 6>;
    using Matrix6X = Eigen::Matrix<double, 6, Eigen::Dynamic>;
    struct Weights {
        Eigen::Index first;  // of the four splines
        double value[3][4];  // derivative, spline
    };
    struct Contact {
        Eigen::Index sample;
        Matrix6 beyond;  // of the tangent stiffness, what it has more than at rest
    };
    void findStiffness(const OpenLoopRun& run, const MountModel& model, double held);
    Weights calcWeights(Eigen::Index sample) const;
    /// B c of six coefficients for each spline, or a derivative of it.
    Matrix6X sumSplines(const Matrix6X& c, int derivative) const;
    /// Bᵀ R, six for each spline.
    Eigen::MatrixXd project(const Eigen::Ref<const Eigen::MatrixXd>& residual) const;

    double corner_ = 0, interval_ = 0;
    Eigen::Index splines_ = 0;
    Eigen::VectorXd taper_, followed_;
    Vector6 freedom_;
    std::vector<Weights> weights_;   // of each sample
    Matrix6 at_rest_;                // tangent stiffness of a sample, but for contacts
    std::vector<Contact> contacts_;  // of those samples where an axis has another stiffness
    Matrix6 least_;                  // what holds the motion where the window hides it, by `held_` of each spline pair
    std::vector<double> held_;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>> factor_;
};

/// Gives `run` the slow motion that balances the slow forces of `model`.
/// @return the balance along the motion that `run` has then; null, and nothing done, where displacements were measured
std::unique_ptr<SlowBalance> followSlowMotion(OpenLoopRun& run, const MountModel& model);

}  // namespace wems::identify
