/// @file
/// What the noise of the recorded channels does to a solution of the regression.
///
/// What the fit leaves tells of the noise only where it does not take it in: a stop that is touched in few instants
/// follows the noise there, and noise that is slower than the time in contact moves the clearance with hardly a trace
/// in the residual. The rigid fit of redundant channels knows that noise beforehand, by its spectrum
/// (noise_density.hpp). With g_j(t) the influence of the motion at time t on parameter j,
///
///     δx = −U Jᵀ δr,    δr = φ*(K(t) n) + φ*(C n') + M φ*n'',
///     var x_j = Σ_f ĝ_j(f)ᴴ S(f) ĝ_j(f),
///
/// K the laws' tangent stiffness along the measured motion, C the dashpots, M the body's mass matrix, S the density of
/// the noise of displacements and accelerations, of both parts. Where the two are fused, g goes back through the
/// fusion, with the weights that it had at each sample: in contact the displacements may decide alone. M takes the
/// accelerations as they are.
#pragma once

#include <Eigen/Core>

#include "identify/fit/solver.hpp"

namespace wems::identify {

/// Variance of each scaled parameter of the system. Of a part whose noise is not known nothing is counted.
Eigen::VectorXd calcChannelNoiseVariances(const Solver& solver, const LinearSystem& system);

}  // namespace wems::identify
