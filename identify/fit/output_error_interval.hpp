/// @file
/// How far the numbers of a fit by simulation can be off, given what the simulations leave.
///
/// What is left is neither white nor the same all along. Two covariances of the least squares are made of it, and the
/// larger holds (White 1980; Newey and West 1987):
///
///     stationary   U (Σ_f J̃ᴴ P(f) J̃) U,       J̃ the derivatives' spectra, P the residual's smoothed cross-spectra
///     by stretches U (Σ_b s_b s_bᵀ) U · B/(B−1), s_b = Σ_{t in b} Jᵀe
///
/// with U = (JᵀJ)⁻¹, from the derivatives at the solution.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/fit/trajectory_problem.hpp"

namespace wems::identify {

class OutputErrorUncertainty {
public:
    /// @param unknowns of the layout
    explicit OutputErrorUncertainty(Eigen::Index unknowns);

    /// Adds a piece with the weight that it had. @param pieces number of all
    void add(const TrajectoryTangent& tangent, double weight, std::size_t pieces = 1);
    /// Once all pieces are there. A direction that is not known to twice its unknowns' scales is taken as not known at
    /// all.
    void solve();

    /// JᵀJ, weighted.
    const Eigen::MatrixXd& information() const { return information_; }
    /// Of Σ a_j x_j, x_j = unknown / scale.
    double calcStandardError(const Eigen::VectorXd& combination) const;
    double calcHalfWidth(const Eigen::VectorXd& combination) const;
    /// The larger variances with the correlation of the stationary version.
    Eigen::MatrixXd makeCovariance() const;

private:
    double calcVarianceByStretches(const Eigen::VectorXd& combination) const;

    Eigen::MatrixXd information_, noise_, covariance_;
    std::vector<Eigen::VectorXd> scores_;  // of each stretch
};

}  // namespace wems::identify
