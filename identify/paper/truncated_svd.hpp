/// @file
/// Linear least squares by truncated singular value decomposition (TSVD), for columns that are nearly dependent.
///
///     A = Σ σ_i u_i v_iᵀ,      x = Σ_{i ≤ rank} (u_iᵀ b / σ_i) v_i
///
/// The small singular values are taken as zero; of all solutions that are left the shortest is chosen. It is right only
/// if the truth happens to have no part along the directions that were left out.
///
/// Confidence factor of a term: residual variance without it over residual variance with all terms. 1: the term
/// explains nothing. With nearly dependent columns the others, refitted, take over for any one term; both versions are
/// given.
///
/// Sources: Golub and Van Loan, Matrix Computations, 5.5; Kerschen, Golinval, Worden (2001),
/// doi:10.1006/jsvi.2000.3490.
#pragma once

#include <Eigen/Core>

namespace wems::identify {

struct TruncatedSolution {
    Eigen::VectorXd x;
    Eigen::VectorXd singular_percent;  ///< singular values, descending, in percent of their sum
    int rank = 0;                      ///< singular values kept
    double residual_fraction = 0;      ///< |b − A x| / |b|
    Eigen::VectorXd confidence;        ///< of each column, the other coefficients as they are
    Eigen::VectorXd
        confidence_refitted;  ///< of each column, the other coefficients refitted (all singular values kept)
};

/// Numerical rank: singular values before the first gap of a factor 20 or more.
int findNumericalRank(const Eigen::VectorXd& singular_values);

/// @param keep singular values to keep; 0: findNumericalRank(); more than there are: all
/// @throws std::invalid_argument if A has no column or fewer rows than columns.
TruncatedSolution solveTruncated(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, int keep);

}  // namespace wems::identify
