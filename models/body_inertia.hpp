/// @file
/// Which matrices are the inertia of a body.
#pragma once

#include <Eigen/Core>
#include <string>

namespace wems {

/// Principal moments (kg m²), ascending.
Eigen::Vector3d calcPrincipalMoments(const Eigen::Matrix3d& inertia);

/// Moments of a body are positive, and none exceeds the sum of the other two: their differences from half the sum are
/// ∫x² dm, ∫y² dm, ∫z² dm along the principal axes.
/// @param principal ascending
/// @returns what is broken, in words that say what a body's are; empty if nothing is
std::string findInertiaProblem(const Eigen::Vector3d& principal);

/// `wanted` if a body has it, otherwise the point on the straight way to it from `believed` where bodies end, less a
/// hundredth of that way. Bodies' inertias form a convex cone, so that there is one such point, and a principal moment
/// is at least a hundredth of the smallest believed one. What `wanted` does not change stays as it is.
/// @param believed of a body @param wanted symmetric and finite
Eigen::Matrix3d limitInertia(const Eigen::Matrix3d& believed, const Eigen::Matrix3d& wanted);

}  // namespace wems
