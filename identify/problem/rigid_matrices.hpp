/// @file
/// The mount as a linear system about its rest position: 6 x 6 matrices about M's origin, translation above rotation.
#pragma once

#include <Eigen/Core>

#include "models/mount_model.hpp"

namespace wems::identify {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

Matrix6 calcMassMatrix(const MobileBody& body);
/// Of the elastomers alone: stops and what else the laws hold left out.
Matrix6 calcStiffnessMatrix(const MountModel& model);
Matrix6 calcDampingMatrix(const MountModel& model);
/// Of the mobile part's six motions: 1 where it is free, 0 where a guide holds it. A guide gives whatever force it
/// must: the equations of held motions say nothing of the mount.
Vector6 calcFreedom(const MobileBody& body);
/// Rows and columns of held motions become those of `diagonal` times one.
void holdMotions(Matrix6& matrix, const Vector6& freedom, double diagonal);
/// (displacement of an axis) = directionᵀ (translation, rotation): (e_a ; r_i × e_a).
Vector6 calcAxisDirection(const MountModel& model, int connection, int axis);

}  // namespace wems::identify
