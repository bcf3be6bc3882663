/// @file
/// Rotations: Bryant angles (body-fixed x-y-z), rotation vectors.
#pragma once

#include <Eigen/Core>

namespace wems {

/// [v]× with [v]× w = v × w.
Eigen::Matrix3d crossMatrix(const Eigen::Vector3d& v);

/// exp([v]×): rotation by |v| (rad) about v.
Eigen::Matrix3d rotationFromVector(const Eigen::Vector3d& v);
/// The inverse, |v| ≤ π.
Eigen::Vector3d vectorFromRotation(const Eigen::Matrix3d& R);

/// Left Jacobian B of SO(3): angular velocity (in the outer frame) = B(v) v'.
Eigen::Matrix3d leftJacobian(const Eigen::Vector3d& v);
/// dB/dt, so that angular acceleration = B(v) v'' + (dB/dt) v'.
Eigen::Matrix3d leftJacobianRate(const Eigen::Vector3d& v, const Eigen::Vector3d& v_dot);

/// R = Rx(α) Ry(β) Rz(γ) from angles (α, β, γ), rad.
Eigen::Matrix3d rotationFromBryant(const Eigen::Vector3d& angles);
/// The inverse; |β| ≤ π/2. At β = ±π/2 α and γ are not determined: throws std::domain_error saying so.
Eigen::Vector3d bryantFromRotation(const Eigen::Matrix3d& R);

/// N with w_GM (in G) = N(α, β) (α', β', γ'). Singular at β = ±π/2, where its inverse throws std::domain_error.
Eigen::Matrix3d bryantRatesToAngularVelocity(const Eigen::Vector3d& angles);
Eigen::Matrix3d angularVelocityToBryantRates(const Eigen::Vector3d& angles);

}  // namespace wems
