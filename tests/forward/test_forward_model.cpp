// Convergence, windows, the two ways of driving a run, markers, use from several threads.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <thread>

#include "identify/forward/step_size.hpp"
#include "models/bryant.hpp"
#include "tests/forward/forward_fixture.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

MountModel makeDevice() {
    MountModel model = test::makeCross();
    model.bracket = test::makeBracketModes();
    for (Connection& connection : model.connections)
        for (AxisLaw& law : connection.axis) law.damping = 1e-3 * law.stiffness;
    return model;
}

/// Errors against 64 steps per sample, with 1, 2, 4 and 8.
std::vector<double> measureConvergence(const MountModel& model, double amplitude) {
    const ForwardModel forward(model);
    const auto run = [&](int steps) {
        const TimeGrid grid = test::makeGrid(1e-3, 401, steps);
        return forward.simulate(Drive::makeLoad(test::makeTimes(grid), test::makeLoad(grid, amplitude), {}, grid)).q;
    };
    const Eigen::MatrixXd reference = run(64);
    std::vector<double> errors;
    for (int steps : {1, 2, 4, 8}) errors.push_back(test::calcRelativeError(run(steps), reference));
    return errors;
}

}  // namespace

TEST_CASE("without contact the error falls with the fourth power of the step") {
    MountModel model = makeDevice();
    model.connections[1].axis[2].cubic = 1e10;
    const std::vector<double> errors = measureConvergence(model, 300);
    CAPTURE(errors[0], errors[1], errors[2], errors[3]);
    CHECK(errors[0] < 2e-3);
    CHECK(std::log2(errors[1] / errors[2]) == Approx(4).margin(0.25));
    CHECK(std::log2(errors[2] / errors[3]) == Approx(4).margin(0.25));
}

TEST_CASE("with stops the error falls with the fourth power of the step") {
    MountModel model = makeDevice();
    for (Connection& connection : model.connections)
        connection.axis[2].stops = {{Side::positive, 2e-4, 8e5, 0.0}, {Side::negative, 2e-4, 8e5, 0.0}};
    const std::vector<double> errors = measureConvergence(model, 300);
    CAPTURE(errors[0], errors[1], errors[2], errors[3]);
    CHECK(errors[0] < 2e-2);
    // Each kink has its own constant: about four in each halving, over all of them.
    CHECK(std::log2(errors[0] / errors[3]) / 3 > 3.3);
    CHECK(errors[3] < 1e-5);
}

TEST_CASE("the recorded motion of the fixed part drives the same run as the load did") {
    MountModel model = makeDevice();
    model.connections[0].axis[2].relaxation = Relaxation{0.3, 0.01};
    for (Connection& connection : model.connections)
        connection.axis[2].stops = {{Side::positive, 2e-4, 8e5, 0.0}, {Side::negative, 2e-4, 8e5, 0.0}};
    model.gravity = {0, 0, -9.81};
    const ForwardModel forward(model);
    const TimeGrid grid = test::makeGrid(5e-4, 1001, 4);
    const std::vector<double> times = test::makeTimes(grid);
    const Drive by_load = Drive::makeLoad(times, test::makeLoad(grid, 300), {}, grid);
    const Simulation loaded = forward.simulate(by_load, Keep::states);

    const Bracket bracket(model.bracket);
    PartMotion fixed;
    for (auto* matrix : {&fixed.p, &fixed.theta, &fixed.v, &fixed.w}) matrix->resize(3, grid.samples);
    for (int k = 0; k < grid.samples; ++k) {
        const ForwardState state = forward.stateAt(loaded, by_load, k);
        const FrameMotion frame = bracket.calcMotion(state.eta, state.eta_dot);
        fixed.p.col(k) = frame.p_GF;
        fixed.theta.col(k) = vectorFromRotation(frame.R_GF);
        fixed.v.col(k) = frame.v_GF;
        fixed.w.col(k) = frame.w_GF;
    }
    const Drive by_motion = Drive::makeFixedMotion(times, fixed, grid);
    const Simulation driven = forward.simulate(by_motion, Keep::states);
    CHECK(loaded.q.cwiseAbs().maxCoeff() > 3e-4);
    CHECK(test::calcRelativeError(driven.q, loaded.q) < 2e-3);

    const MarkerMotion a = forward.calcMarkers(loaded, by_load), b = forward.calcMarkers(driven, by_motion);
    CHECK(test::calcRelativeError(b.fixed_displacement, a.fixed_displacement) < 1e-10);
    CHECK(test::calcRelativeError(b.fixed_acceleration.middleCols(1, 999), a.fixed_acceleration.middleCols(1, 999)) <
          0.03);
}

TEST_CASE("windows that start from the states of a run continue that run") {
    MountModel model = makeDevice();
    model.connections[0].axis[2].relaxation = Relaxation{0.3, 0.01};
    model.connections[1].axis[2].drift = 0.5;
    const ForwardModel forward(model);
    const TimeGrid grid = test::makeGrid(1e-3, 301, 2);
    const Drive drive = Drive::makeLoad(test::makeTimes(grid), test::makeLoad(grid, 300), {}, grid);
    const Simulation whole = forward.simulate(drive, Keep::states);
    const Simulation window = forward.simulate(drive, forward.stateAt(whole, drive, 120), 120, 100);
    CHECK(window.first_sample == 120);
    CHECK(test::calcRelativeError(window.q, whole.q.middleCols(120, 100)) < 1e-11);
    CHECK((window.final_state.eta - forward.stateAt(whole, drive, 219).eta).norm() < 1e-15);
    CHECK_THROWS_AS(forward.simulate(drive, forward.restState(), 250, 100), std::invalid_argument);
}

TEST_CASE("marker accelerations are the second differences of marker displacements") {
    MountModel model = makeDevice();
    model.gravity = {0, 0, -9.81};
    model.body.spin = {0, 0, 1};
    const ForwardModel forward(model);
    const double interval = 1e-4;
    const TimeGrid grid = test::makeGrid(interval, 3001);
    const Drive drive = Drive::makeLoad(test::makeTimes(grid), test::makeLoad(grid, 500), {}, grid);
    const MarkerMotion markers = forward.calcMarkers(forward.simulate(drive, Keep::states), drive);
    const auto differ = [&](const Eigen::MatrixXd& x) -> Eigen::MatrixXd {
        const Eigen::Index n = x.cols() - 2;
        return (x.leftCols(n) - 2 * x.middleCols(1, n) + x.rightCols(n)) / (interval * interval);
    };
    const auto inner = [](const Eigen::MatrixXd& x) -> Eigen::MatrixXd { return x.middleCols(1, x.cols() - 2); };
    CHECK(markers.mobile_displacement.col(0).norm() < 1e-15);
    CHECK(test::calcRelativeError(differ(markers.mobile_displacement), inner(markers.mobile_acceleration)) < 1e-3);
    CHECK(test::calcRelativeError(differ(markers.fixed_displacement), inner(markers.fixed_acceleration)) < 1e-3);
}

TEST_CASE("threads with models of their own get what they would get alone") {
    MountModel first = makeDevice(), second = makeDevice();
    second.body.mass *= 1.1;
    const TimeGrid grid = test::makeGrid(1e-3, 401, 2);
    const Drive drive = Drive::makeLoad(test::makeTimes(grid), test::makeLoad(grid, 300), {}, grid);
    const ForwardModel a(first), b(second);
    const Eigen::MatrixXd alone_a = a.simulate(drive).q, alone_b = b.simulate(drive).q;
    Eigen::MatrixXd q_a, q_b;
    std::thread thread([&] { q_a = a.simulate(drive).q; });
    q_b = b.simulate(drive).q;
    thread.join();
    CHECK(q_a == alone_a);
    CHECK(q_b == alone_b);
    CHECK(test::calcRelativeError(alone_b, alone_a) > 1e-3);
}

TEST_CASE("the step follows the stiffest contact and the fastest damper") {
    MountModel model;
    model.body.mass = 2;
    model.body.inertia = Eigen::Matrix3d::Identity();
    model.connections.resize(1);
    model.connections[0].name = "1";
    AxisLaw& law = model.connections[0].axis[2];
    law.stiffness = 1e5;
    law.stops = {{Side::positive, 1e-3, 7e5, 0.0}, {Side::negative, 1e-3, 3e5, 0.0}};
    CHECK(calcFastestRates(model).frequency == Approx(std::sqrt(8e5 / 2)));
    law.damping = 100;
    law.friction = Friction{12, 1e-3, {}};
    CHECK(calcFastestRates(model).damping == Approx((100 + 12e3) / 2));
    CHECK(chooseStepsPerSample(model, 1e-6) == 1);
    CHECK(chooseStepsPerSample(model, 1e-2) > chooseStepsPerSample(model, 1e-3));
    law.friction.reset();
    law.relaxation = Relaxation{0.1, 1e-5};
    CHECK(calcFastestRates(model).damping == Approx(1e5));
}

TEST_CASE("a law that settles within a thousandth of a sample is refused before a step, whatever the rate") {
    MountModel model;
    model.body.mass = 2;
    model.body.inertia.setIdentity();
    model.connections.resize(1);
    model.connections[0].name = "1";
    AxisLaw& law = model.connections[0].axis[2];
    law.stiffness = 1;
    const double interval = GENERATE(1e-2, 1e-3, 1e-5);
    // At its centre of gravity the dashpot's rate is c/m; a step takes 1.5 of it.
    const auto damp = [&](double steps) { law.damping = 1.5 * steps / interval * model.body.mass; };
    damp(999.5);
    CHECK(chooseStepsPerSample(model, interval) == 1000);
    for (const double steps : {1001.0, 1e6, 1e12, 1e100}) {
        damp(steps);
        CHECK_THROWS_AS(chooseStepsPerSample(model, interval), SimulationDiverged);
    }
    law.damping = 0;
    law.stiffness = std::pow(0.8 * 2000 / interval, 2) * model.body.mass;
    CHECK_THROWS_WITH(chooseStepsPerSample(model, interval), Catch::Contains("too stiff to be simulated: a rate of"));
}

TEST_CASE("a run that grows beyond all bounds is reported, not returned") {
    MountModel model = makeDevice();
    model.connections[0].axis[2].cubic = -1e13;
    const ForwardModel forward(model);
    const TimeGrid grid = test::makeGrid(1e-3, 2001, 1);
    const Drive drive = Drive::makeLoad(test::makeTimes(grid), test::makeLoad(grid, 3000), {}, grid);
    CHECK_THROWS_AS(forward.simulate(drive), SimulationDiverged);
}
