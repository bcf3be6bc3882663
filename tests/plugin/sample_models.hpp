/// @file
/// Models for the tests of the plugin: small, unsymmetric, with everything that a model can have.
#pragma once

#include <Eigen/Geometry>
#include <string>

#include "models/mount_model.hpp"

namespace wems::test {

/// Three connections at no special place, laws different along each axis, heavy enough to move by millimetres.
inline MountModel makeRigidModel() {
    MountModel model;
    model.name = "unsymmetric";
    model.body.mass = 5;
    model.body.center_of_gravity = {0.012, -0.02, 0.08};
    model.body.inertia << 0.05, 0.004, -0.003, 0.004, 0.06, 0.002, -0.003, 0.002, 0.04;
    const double positions[3][3] = {{0.1, 0.01, -0.02}, {-0.06, 0.08, 0.01}, {-0.05, -0.09, 0.015}};
    for (int i = 0; i < 3; ++i) {
        Connection connection;
        connection.name = std::to_string(i + 1);
        connection.position = Eigen::Vector3d(positions[i][0], positions[i][1], positions[i][2]);
        for (int k = 0; k < 3; ++k) connection.axis[k].stiffness = 2e4 + 5e3 * k + 1e3 * i;
        model.connections.push_back(connection);
    }
    return model;
}

/// Adds stops on every axis, reached at 1 mm or so.
inline MountModel withStops(MountModel model) {
    double clearance = 0.8e-3;
    for (Connection& connection : model.connections)
        for (AxisLaw& law : connection.axis) {
            law.stops.push_back({Side::positive, clearance, 3e5, 0});
            law.stops.push_back({Side::negative, 1.1 * clearance, 2e5, 0});
            clearance += 0.1e-3;
        }
    return model;
}

/// Adds every way of losing energy.
inline MountModel withLosses(MountModel model) {
    for (Connection& connection : model.connections) {
        for (AxisLaw& law : connection.axis) law.damping = 15;
        for (Stop& stop : connection.axis[1].stops) stop.dissipation = 0.5;
    }
    model.connections[0].axis[0].relaxation = Relaxation{0.3, 0.01};
    model.connections[1].axis[1].loss_factor = 0.1;
    model.connections[2].axis[2].friction = Friction{2.0, 5e-3, {}};
    model.connections[2].axis[0].friction = Friction{1.5, 1e-3, 5e4};
    model.connections[1].axis[0].hysteresis = Hysteresis{2.0, 1e-4, 1.5, 0.7};
    return model;
}

/// Adds a bracket of four modes, all of them moving and turning the interface.
inline MountModel withBracket(MountModel model) {
    const double shapes[4][6] = {{0.2, 0.02, -0.03, 0.1, 0.9, -0.2},
                                 {-0.03, 0.18, 0.05, -0.8, 0.1, 0.15},
                                 {0.01, 0.04, 0.25, 0.5, -0.3, 0.4},
                                 {0.05, -0.06, 0.07, 0.6, 0.7, 1.2}};
    const double frequencies[4] = {31, 38, 52, 90};
    for (int j = 0; j < 4; ++j) {
        BracketMode mode;
        mode.frequency = frequencies[j];
        mode.damping_ratio = 0.01 + 0.002 * j;
        mode.translation = Eigen::Vector3d(shapes[j][0], shapes[j][1], shapes[j][2]);
        mode.rotation = Eigen::Vector3d(shapes[j][3], shapes[j][4], shapes[j][5]);
        mode.load_translation = mode.translation + mode.rotation.cross(Eigen::Vector3d(0.01, 0.02, -0.03));
        model.bracket.push_back(mode);
    }
    return model;
}

}  // namespace wems::test
