/// @file
/// Rates of a rotation vector θ, R = exp([θ]×), and angular velocity ω = B(θ) θ', in the outer frame. B is the left
/// Jacobian of SO(3), B = I + c1 [θ]× + c2 [θ]×², c1 = (1 − cos θ)/θ², c2 = (θ − sin θ)/θ³.
#pragma once

#include <Eigen/Core>

namespace wems::identify {

/// ω = B θ' (rad/s).
Eigen::Vector3d calcAngularVelocity(const Eigen::Vector3d& theta, const Eigen::Vector3d& theta_dot);

/// α = B θ'' + B' θ' (rad/s²).
Eigen::Vector3d calcAngularAcceleration(const Eigen::Vector3d& theta, const Eigen::Vector3d& theta_dot,
                                        const Eigen::Vector3d& theta_dot_dot);

/// θ' from ω; |θ| < 2π.
Eigen::Vector3d calcVectorRate(const Eigen::Vector3d& theta, const Eigen::Vector3d& w);

/// θ'' from α; |θ| < 2π.
Eigen::Vector3d calcVectorAcceleration(const Eigen::Vector3d& theta, const Eigen::Vector3d& theta_dot,
                                       const Eigen::Vector3d& alpha);

}  // namespace wems::identify
