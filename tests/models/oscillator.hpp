/// @file
/// One body on one connection at its centre of gravity: an oscillator along each axis.
#pragma once

#include <Eigen/Geometry>

#include "models/linear_response.hpp"

namespace wems::test {

inline MountModel makeOscillator(double mass, double stiffness, double damping) {
    MountModel model;
    model.body.mass = mass;
    model.body.inertia = Eigen::Vector3d(0.1, 0.2, 0.3).asDiagonal();
    Connection connection;
    connection.name = "1";
    for (AxisLaw& law : connection.axis) {
        law.stiffness = stiffness;
        law.damping = damping;
    }
    model.connections.push_back(connection);
    return model;
}

/// The base acceleration that acts as this force on a mass.
inline HarmonicInput driveBy(double force, double mass) {
    return {Eigen::Vector3d::Zero(), Eigen::Vector3d(0, 0, force / mass)};
}

}  // namespace wems::test
