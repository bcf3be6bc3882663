/// @file
/// What the noise of the recorded channels adds to the inner products of the equations' columns. Regressors are
/// measured, too: without subtracting this, a motion that was never excited would seem to identify a stiffness from
/// noise alone, and every estimate would be drawn towards zero (errors in variables).
///
/// Pose noise n (translation, rotation; white over samples, of the part's six degrees of freedom as the rigid fit
/// leaves it) reaches column j as L_j n filtered by T_j(f): the test function times 1, iω or −ω² for columns of
/// displacement, velocity and acceleration. With Σ the covariance of n and W the weight of the equations, per output
///
///     E[x_jᵀ W x_l] = tr(L_jᵀ W L_l Σ) · (2/f_s) ∫ Re(T_j T_l*) df.
///
/// Source: Fuller, Measurement Error Models (1987), ch. 2.
#pragma once

#include <Eigen/Core>

#include "identify/fit/equation_of_motion.hpp"

namespace wems::identify {

/// Expected inner products (layout.count() squared) of the noise in all linear columns, one run, summed over outputs.
/// @param whitening of the run's rows
Eigen::MatrixXd calcNoiseProducts(const RunMotion& motion, const MountModel& model, const RunEquations& equations,
                                  const Matrix6d& whitening);

}  // namespace wems::identify
