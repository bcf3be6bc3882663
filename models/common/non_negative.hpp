/// @file
/// Least squares in which some coefficients may not be negative: relaxation spectra, distributions of sliders.
/// Source: Lawson, Hanson, Solving Least Squares Problems (1974), ch. 23 (NNLS), on the normal equations.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace wems {

/// min |X β − y| with β_j ≥ 0 where `bounded[j]`; at the solution the gradient of a coefficient that is held at zero
/// would push it below.
/// @param gram XᵀX, @param right Xᵀy; columns of norms that do not differ by many powers of ten
Eigen::VectorXd solveNonNegative(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right,
                                 const std::vector<bool>& bounded);

}  // namespace wems
