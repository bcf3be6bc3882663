// Conserved quantities: what the equations of motion keep whatever the numbers are.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "tests/forward/forward_fixture.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

/// Angular momentum of body and wheel about the CoG, in G.
Eigen::Vector3d calcAngularMomentum(const MobileBody& body, const BodyMotion& motion) {
    return motion.R_GM * (body.inertia * (motion.R_GM.transpose() * motion.w_GM) + body.spin);
}

}  // namespace

TEST_CASE("a torque-free body with a wheel keeps momentum, energy and the course of its CoG while it tumbles") {
    MountModel model = test::makeFreeBody();
    model.body.spin = {0.1, -0.2, 0.4};
    const ForwardModel forward(model);
    const Drive drive = Drive::makeFree(test::makeGrid(0.01, 301, 20));
    ForwardState initial = forward.restState();
    initial.mobile.w_GM = {3, -2, 5};  // turns several times
    initial.mobile.v_GM = {0.2, 0.1, -0.3};
    const Simulation run = forward.simulate(drive, initial, 0, 301, Keep::states);
    const Eigen::Vector3d momentum = calcAngularMomentum(model.body, initial.mobile);
    const double energy = forward.calcEnergy(run, drive, 0);
    const auto calcCog = [&](const BodyMotion& m) -> Eigen::Vector3d {
        return m.p_GM + m.R_GM * model.body.center_of_gravity;
    };
    const Eigen::Vector3d velocity =
        initial.mobile.v_GM + initial.mobile.w_GM.cross(initial.mobile.R_GM * model.body.center_of_gravity);
    double largest_turn = 0;
    for (int k : {50, 150, 300}) {
        const ForwardState state = forward.stateAt(run, drive, k);
        CHECK((calcAngularMomentum(model.body, state.mobile) - momentum).norm() < 1e-9 * momentum.norm());
        CHECK(forward.calcEnergy(run, drive, k) == Approx(energy).epsilon(1e-9));
        CHECK((calcCog(state.mobile) - calcCog(initial.mobile) - 0.01 * k * velocity).norm() < 1e-10);
        largest_turn = std::max(largest_turn, (state.mobile.R_GM - Eigen::Matrix3d::Identity()).norm());
    }
    CHECK(largest_turn > 1);
}

TEST_CASE("energy plus dissipated energy stays constant with every mechanism in play") {
    MountModel model = test::makeCross();
    model.gravity = {0, 0.5, -9.81};
    model.body.spin = {0, 0, 0.3};
    model.bracket = test::makeBracketModes();
    auto& axial = model.connections[3].axis[2];
    axial.damping = 40;
    axial.offset = 1e-4;
    axial.quadratic = 2e6;
    axial.cubic = 1e9;
    axial.stops = {{Side::positive, 1.2e-3, 8e5, 2.0}, {Side::negative, 1.5e-3, 8e5, 0.0}};
    model.connections[0].axis[0].relaxation = Relaxation{0.3, 0.01};
    model.connections[1].axis[1].loss_factor = 0.1;
    model.connections[2].axis[0].friction = Friction{3.0, 1e-2, {}};
    model.connections[2].axis[1].friction = Friction{3.0, 1e-3, 1e5};
    model.connections[3].axis[1].hysteresis = Hysteresis{3.0, 2e-4, 1.5, 0.7};
    const ForwardModel forward(model);
    constexpr int samples = 2001;
    const Drive drive = Drive::makeFree(test::makeGrid(2e-4, samples, 4));
    ForwardState initial = forward.restState();
    initial.mobile.v_GM += Eigen::Vector3d(0.1, -0.1, 0.5);
    const Simulation run = forward.simulate(drive, initial, 0, samples, Keep::states);
    REQUIRE(run.q.row(11).maxCoeff() > 1.3e-3);  // the stop with dissipation is reached

    double dissipated = 0;  // Simpson's rule over the samples
    for (int k = 0; k < samples; ++k) {
        const double weight = k == 0 || k == samples - 1 ? 1 : k % 2 == 1 ? 4 : 2;
        dissipated += weight * 2e-4 / 3 * forward.calcDissipatedPower(run, drive, k);
    }
    const double lost = forward.calcEnergy(run, drive, 0) - forward.calcEnergy(run, drive, samples - 1);
    CHECK(dissipated > 0.05);
    CHECK(lost == Approx(dissipated).epsilon(2e-4));
}

TEST_CASE("what rests in its static equilibrium stays there") {
    MountModel model = test::makeCross();
    model.gravity = {3, -2, -9.81};
    model.bracket = test::makeBracketModes();
    model.connections[0].axis[2].relaxation = Relaxation{0.3, 0.01};
    model.connections[1].axis[2].stops = {{Side::negative, 1e-4, 8e5, 0.0}};
    const ForwardModel forward(model);
    REQUIRE(forward.restDisplacement()[5] < -1e-4);  // the stop carries load at rest
    const Simulation run = forward.simulate(Drive::makeFree(test::makeGrid(1e-3, 501, 4)));
    CHECK((run.q.colwise() - forward.restDisplacement()).cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("a stop that touches at rest, its offset beyond its clearance, moves the rest position without gravity") {
    MountModel model = test::makeCross();
    model.connections[0].axis[2].offset = 2e-3;
    model.connections[0].axis[2].stops = {{Side::positive, 1.5e-3, 8e5, 0.0}};
    const ForwardModel forward(model);
    REQUIRE(forward.restDisplacement()[2] < -1e-4);
    const Simulation run = forward.simulate(Drive::makeFree(test::makeGrid(1e-3, 201, 4)));
    CHECK((run.q.colwise() - forward.restDisplacement()).cwiseAbs().maxCoeff() < 1e-12);
}
