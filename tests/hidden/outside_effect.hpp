/// @file
/// What no cause of the catalogue describes: a force at one axis of one connection.
#pragma once

#include <Eigen/Core>
#include <string>

#include "models/mount_model.hpp"
#include "tests/hidden/random_numbers.hpp"

namespace wems::hidden {

struct OutsideEffect {
    enum class Kind { none, periodic_stiffness, disturbance, cross_axis, buckling };
    Kind kind = Kind::none;
    int connection = 0, axis = 0;
    int other_axis = 0;    ///< cross_axis: the axis whose displacement drives the force
    double size = 0;       ///< N/m (periodic_stiffness) or N
    double length = 1e-3;  ///< m, cross_axis and buckling
    double frequency = 0;  ///< Hz, periodic_stiffness and disturbance

    /// N along the axis, on the mobile part with the opposite sign; q the relative displacements of the connection.
    double calcForce(const Eigen::Vector3d& q, double time) const;
};
std::string formatKind(OutsideEffect::Kind kind);

/// A first guess of its size. @param axis_only at z, and of the kinds that need no other axis
OutsideEffect drawOutside(const MountModel& model, bool axis_only, Random& random);

}  // namespace wems::hidden
