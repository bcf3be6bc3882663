/// @file
/// Linear least squares with covariance from blocks, and its extension to breakpoints by variable projection.
///
/// Residuals of a restoring force are never white: what the law lacks, a sensor's ripple, a filter repeat from sample
/// to sample. The covariance is therefore built from the sums of the scores over blocks of neighbouring samples,
///
///     cov = (XᵀX)⁻¹ [ B/(B−p) Σ_b g_b g_bᵀ ] (XᵀX)⁻¹,   g_b = Σ_{i in b} x_i r_i,
///
/// which holds for any correlation shorter than a block, and the quantile is Student's with B − p degrees of freedom.
/// Cluster-robust covariance: Liang, Zeger (1986), doi:10.1093/biomet/73.1.13; few blocks: Bester, Conley, Hansen
/// (2011), doi:10.1016/j.jeconom.2011.01.007.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace wems::identify {

/// Estimates of a least-squares problem.
struct Estimates {
    Eigen::VectorXd value;
    Eigen::MatrixXd covariance;
    double degrees_of_freedom = 0;  ///< blocks − parameters
    int blocks = 0;
    double correlation_length = 1;  ///< samples, integrated autocorrelation of the residual
    Eigen::VectorXd residual;
    double fraction = 0;  ///< root mean square of the residual over that of the data about its mean

    /// Half width of the 95 % interval of a linear combination of the values.
    double calcHalfWidth(const Eigen::VectorXd& combination) const;
    double calcHalfWidth(Eigen::Index parameter) const;
};

/// Solves min |X β − y|. `run_starts`: first row of each recording; no block straddles two. Columns that depend on
/// each other linearly get an infinite interval.
Estimates solveBlocks(const Eigen::MatrixXd& X, const Eigen::VectorXd& y, const std::vector<Eigen::Index>& run_starts);

/// A change of slope at `position`: side + is max(q − position, 0), side − is min(q − position, 0).
struct Hinge {
    int side = 1;
    double position = 0;
};

/// A law that is linear in the columns of `base` and bends at hinges of unknown position.
struct HingeProblem {
    Eigen::MatrixXd base;      ///< samples x linear columns
    Eigen::VectorXd q, y;      ///< m, N
    std::vector<Hinge> start;  ///< sides; a position other than zero is tried as a start, besides a grid
    std::vector<Eigen::Index> run_starts;
};

/// Values: base coefficients, then the hinges' slopes, then their positions.
struct HingeFit {
    std::vector<Hinge> hinges;
    Estimates estimates;
};

/// Variable projection (Golub, Pereyra 1973): the positions by a grid over the range of q (side + above zero, side −
/// below zero unless `anywhere`) and Gauss–Newton on all parameters from the best points.
HingeFit fitHinges(const HingeProblem& problem, bool anywhere);

}  // namespace wems::identify
