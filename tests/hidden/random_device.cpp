#include <Eigen/Geometry>
#include <cmath>

#include "models/common/units.hpp"
#include "tests/hidden/random_case.hpp"

namespace wems::hidden {
namespace {

BracketMode drawMode(Random& random, double frequency, double mass, int translation, int rotation, double lever) {
    BracketMode mode;
    mode.frequency = frequency * drawUniform(random, 0.92, 1.08);
    mode.damping_ratio = drawUniform(random, 0.008, 0.02);
    const double scale = 1 / std::sqrt(mass);
    const Eigen::Vector3d point(drawUniform(random, -0.01, 0.01), drawUniform(random, -0.01, 0.01), 0.02);
    for (int a = 0; a < 3; ++a) {
        mode.translation[a] = scale * (a == translation ? 1.0 : drawUniform(random, -0.03, 0.03));
        mode.rotation[a] = scale * (a == rotation ? lever : drawUniform(random, -0.2, 0.2));
    }
    mode.load_translation = mode.translation + mode.rotation.cross(point);
    return mode;
}

}  // namespace

MountModel drawDevice(Random& random) {
    MountModel model;
    model.name = "random device";
    const int count = drawInteger(random, 3, 6);
    const double mass = drawUniform(random, 5, 13);
    model.body.mass = mass;
    const double aside = drawInteger(random, 0, 1) == 0 ? 0.0 : 0.015;
    model.body.center_of_gravity = {drawUniform(random, -aside, aside), drawUniform(random, -aside, aside),
                                    drawUniform(random, 0.0, 0.12)};
    const double gyration = drawUniform(random, 0.06, 0.1);
    for (int a = 0; a < 3; ++a)
        model.body.inertia(a, a) = mass * gyration * gyration * drawUniform(random, 0.85, 1.15) * (a == 2 ? 0.8 : 1.0);
    const double w = kTwoPi * drawUniform(random, 24, 34);
    const double axial = mass * w * w / count, lateral = axial * drawUniform(random, 0.22, 0.6);
    const double damping = drawUniform(random, 0.02, 0.06) * 2 / w;
    const double clearance = drawUniform(random, 1.0e-3, 2.2e-3);
    const double stop = axial * drawUniform(random, 5, 13);
    for (int i = 0; i < count; ++i) {
        Connection connection;
        connection.name = std::to_string(i + 1);
        const double angle = kTwoPi * (i + drawUniform(random, -0.15, 0.15)) / count;
        const double radius = drawUniform(random, 0.06, 0.12);
        connection.position = {radius * std::cos(angle), radius * std::sin(angle), drawUniform(random, -0.02, 0.03)};
        for (std::size_t a = 0; a < 3; ++a) {
            auto& law = connection.axis[a];
            law.stiffness = (a == 2 ? axial : lateral) * drawUniform(random, 0.85, 1.15);
            law.damping = damping * law.stiffness;
        }
        connection.axis[2].stops = {{Side::positive, clearance, stop, 0}, {Side::negative, clearance, stop, 0}};
        const std::size_t outward = std::abs(connection.position.x()) > std::abs(connection.position.y()) ? 0 : 1;
        const Eigen::Index component = outward;
        const Side side = connection.position[component] > 0 ? Side::positive : Side::negative;
        connection.axis[outward].stops = {{side, 1.3 * clearance, 0.4 * stop, 0}};
        model.connections.push_back(connection);
    }
    model.bracket = {drawMode(random, 64, 16, 2, 0, 4),    drawMode(random, 85, 16, 0, 1, -4),
                     drawMode(random, 110, 16, 1, 0, 3),   drawMode(random, 150, 50, 2, 0, 6),
                     drawMode(random, 34, 100, 0, 1, 0.4), drawMode(random, 38, 100, 1, 0, -0.4),
                     drawMode(random, 43, 140, 2, 0, 0.3)};
    model.bracket_file = "bracket.csv";
    return model;
}

MountModel drawAxisDevice(Random& random) {
    MountModel model;
    model.name = "random rig";
    model.body.free = {false, false, true, false, false, false};
    model.body.mass = drawLog(random, 0.5, 10);
    model.body.inertia = 1e-2 * model.body.mass * Eigen::Matrix3d::Identity();
    const int count = drawInteger(random, 1, 2);
    const double w = kTwoPi * drawUniform(random, 12, 30);
    const double stiffness = model.body.mass * w * w / count;
    const double damping = drawUniform(random, 0.02, 0.06) * 2 / w, clearance = drawUniform(random, 1.0e-3, 2.2e-3);
    const double stop = stiffness * drawUniform(random, 5, 13);
    for (int i = 0; i < count; ++i) {
        Connection connection;
        connection.name = std::to_string(i + 1);
        if (count > 1) connection.position.x() = i == 0 ? -0.1 : 0.1;
        auto& law = connection.axis[2];
        law.stiffness = stiffness * drawUniform(random, 0.8, 1.25);
        law.damping = damping * law.stiffness;
        law.stops = {{Side::positive, clearance, stop, 0}, {Side::negative, clearance, stop, 0}};
        model.connections.push_back(connection);
    }
    return model;
}

}  // namespace wems::hidden
