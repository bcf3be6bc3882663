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
/// (displacement of an axis) = directionᵀ (translation, rotation): (e_a ; r_i × e_a).
Vector6 calcAxisDirection(const MountModel& model, int connection, int axis);

}  // namespace wems::identify
