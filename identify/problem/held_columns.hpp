/// @file
/// The equations of a run at a further point, with the columns of an earlier one (the chord method, or modified Newton;
/// Ortega and Rheinboldt, "Iterative Solution of Nonlinear Equations in Several Variables").
///
/// What is left, r, is that of the point itself, under its own covariance. What its numbers make of it, J, is held:
/// forming all columns takes several times as long as the equations alone. A step of held columns ends where J_heldᵀ r
/// and the prior balance, which is near where Jᵀ r does; what comes to rest is looked at once more with its own
/// columns.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "identify/problem/block_columns.hpp"
#include "identify/problem/information.hpp"

namespace wems::identify {

class Lineariser;
struct LinearisedRun;

/// Columns of the blocks that are not linear in their numbers.
struct KeptColumns {
    BlockColumns mount, bracket;
    Eigen::MatrixXd transients;  ///< of the bracket's free decays, which come last there (marginalise)
};

/// A run about a further point. What the noise of the regressors makes follows the misfit, as it was formed from it.
/// @param from about the earlier point, with its columns; @param moved the unknowns from there
/// @param at of the further point; @param misfit of it (calcMisfit)
/// @return none where no columns were kept, or where other frequencies count
std::optional<LinearisedRun> holdColumns(const LinearisedRun& from, const Eigen::VectorXd& moved, const Lineariser& at,
                                         const Information& misfit);

}  // namespace wems::identify
