/// @file
/// How well a solution is known: covariance of the parameters with residuals that are correlated in time.
///
/// With U the inverse of the information JᵀJ (whitened rows) the covariance is U Jᵀ Γ J U (sandwich). Γ, the covariance
/// of the residual, is taken in three ways, and the largest answer counts:
/// - stationary: an autoregressive model of each whitened equation's residual, so that JᵀΓJ = |A⁻¹ J|²;
/// - blocks: sums of Jᵀr over blocks of time, which needs no stationarity (contact makes residuals larger there);
/// - the noise that redundant channels show beforehand (channel_noise_effect.hpp), which a fit may have taken in.
///
/// To this comes what the scatter of the channels' gains may do (calibration_effect.hpp), where the rigid fit shows
/// any.
///
/// Sources: White (1980), doi:10.2307/1912934; Newey and West (1987), doi:10.2307/1913610; AR by Burg–Yule–Walker.
#pragma once

#include <Eigen/Core>

#include "identify/fit/calibration_effect.hpp"
#include "identify/fit/solver.hpp"

namespace wems::identify {

// Quantiles for intervals.

/// Two-sided 95 % quantile of Student's t, e.g. 1.96 for many degrees of freedom; infinite for fewer than one.
double studentQuantile95(double degrees_of_freedom);

/// Covariance of the system's parameters, scaled as there.
class ParameterUncertainty {
public:
    ParameterUncertainty(const Solver& solver, const LinearSystem& system);

    /// Standard error of Σ a_j x_j, x the scaled parameters.
    double calcStandardError(const Eigen::VectorXd& combination) const;
    /// Half width of the 95 % interval of the same.
    double calcHalfWidth(const Eigen::VectorXd& combination) const;
    /// The elementwise larger diagonal with the correlation of the stationary version.
    Eigen::MatrixXd makeCovariance() const;
    /// Sum of squares of the whitened residual that the scatter of gains leaves on average.
    double calibrationSquares() const { return calibration_.residual_squares; }

private:
    Eigen::MatrixXd stationary_;  // covariance, widened where the channels' noise makes more
    Eigen::MatrixXd influences_;  // parameters × blocks: U Jᵀr of each block
    CalibrationEffect calibration_;
};

}  // namespace wems::identify
