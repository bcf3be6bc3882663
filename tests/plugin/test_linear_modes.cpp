// Linearisation: natural frequencies of known systems.
#include <catch2/catch.hpp>
#include <cmath>

#include "models/common/units.hpp"
#include "models/linear_modes.hpp"
#include "tests/plugin/sample_models.hpp"

using namespace wems;

namespace {}

TEST_CASE("the shipped small satellite has the published coupled frequencies") {
    const MountModel model = readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
    const LinearModes modes = findLinearModes(linearize(model, 15));
    const double published[] = {11.2, 11.4, 29.5, 30.5, 31.2, 32.4, 35.3, 37.8, 45.3};
    for (const double frequency : published) {
        const double nearest = (modes.frequency.array() - frequency).abs().minCoeff();
        CAPTURE(frequency, modes.frequency.transpose());
        CHECK(nearest < 0.1);
    }
}

TEST_CASE("one mass on one spring, off centre: bounce and rock by hand") {
    // Connections at ±a on x, equal stiffness k along z; the centre of gravity in the middle.
    MountModel model;
    model.body.mass = 2;
    model.body.inertia = Eigen::Vector3d(0.01, 0.02, 0.03).asDiagonal();
    const double a = 0.15, k = 1e4, lateral = 3e4;
    for (const double x : {-a, a}) {
        Connection connection;
        connection.name = x < 0 ? "1" : "2";
        connection.position = {x, 0, 0};
        connection.axis[0].stiffness = connection.axis[1].stiffness = lateral;
        connection.axis[2].stiffness = k;
        model.connections.push_back(connection);
    }
    const LinearModes modes = findLinearModes(linearize(model, 15));
    const double bounce = std::sqrt(2 * k / 2) / kTwoPi, rock = std::sqrt(2 * k * a * a / 0.02) / kTwoPi;
    const double slide = std::sqrt(2 * lateral / 2) / kTwoPi, yaw = std::sqrt(2 * lateral * a * a / 0.03) / kTwoPi;
    for (const double expected : {bounce, rock, slide, yaw, 0.0}) {  // nothing holds the rotation about x
        CAPTURE(expected, modes.frequency.transpose());
        CHECK((modes.frequency.array() - expected).abs().minCoeff() < 1e-6 * bounce + 1e-3 * (expected == 0));
    }
}

TEST_CASE("gravity: a pendulum below its mount, and no equilibrium on top of a needle") {
    // One connection, stiff in translation: the body swings about it with ω² = m g c / (I + m c²).
    MountModel model;
    model.body.mass = 3;
    model.body.center_of_gravity = {0, 0, -0.2};
    model.body.inertia = Eigen::Vector3d(0.04, 0.04, 0.04).asDiagonal();
    model.gravity = {0, 0, -9.81};
    Connection connection;
    connection.name = "1";
    for (AxisLaw& law : connection.axis) law.stiffness = 1e9;
    model.connections.push_back(connection);
    const LinearModes modes = findLinearModes(linearize(model, 15));
    const double pendulum = std::sqrt(3 * 9.81 * 0.2 / (0.04 + 3 * 0.04)) / kTwoPi;
    CAPTURE(modes.frequency.transpose());
    CHECK(modes.frequency(0) < 1e-3);  // turning about the vertical
    CHECK(modes.frequency(1) == Approx(pendulum).epsilon(1e-5));
    CHECK(modes.frequency(2) == Approx(pendulum).epsilon(1e-5));

    model.body.center_of_gravity.z() = 0.2;
    CHECK_THROWS(findLinearModes(linearize(model, 15)));
}

TEST_CASE("a Maxwell branch stiffens and damps as E' and E'' at the reference frequency say") {
    MountModel model = test::makeRigidModel();
    const double ratio = 0.3, tau = 0.01, frequency = 20;
    for (Connection& connection : model.connections)
        for (AxisLaw& law : connection.axis) law.relaxation = Relaxation{ratio, tau};
    const LinearSystem with = linearize(model, frequency);
    for (Connection& connection : model.connections)
        for (AxisLaw& law : connection.axis) law.relaxation.reset();
    const LinearSystem without = linearize(model, frequency);
    const double wt = kTwoPi * frequency * tau;
    const double storage = 1 + ratio * wt * wt / (1 + wt * wt), loss = ratio * tau / (1 + wt * wt);
    CHECK((with.stiffness - storage * without.stiffness).norm() < 1e-6 * without.stiffness.norm());
    CHECK((with.damping - loss * without.stiffness).norm() < 1e-6 * with.damping.norm());
}
