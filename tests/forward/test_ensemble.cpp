// Parameter sets side by side against each alone.
#include <catch2/catch.hpp>
#include <random>

#include "identify/forward/ensemble.hpp"
#include "identify/forward/lanes.hpp"
#include "models/bryant.hpp"
#include "tests/forward/forward_fixture.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

/// A device with every kind of term, its numbers drawn.
MountModel drawDevice(std::mt19937& random, bool with_bracket) {
    const auto vary = [&](double value) { return value * std::uniform_real_distribution<double>(0.9, 1.1)(random); };
    MountModel model = test::makeCross();
    if (with_bracket) model.bracket = test::makeBracketModes();
    for (BracketMode& mode : model.bracket) mode.frequency = vary(mode.frequency);
    model.body.mass = vary(model.body.mass);
    model.body.spin = {0, 0, vary(0.5)};
    model.gravity = {0, 0, -9.81};
    for (Connection& connection : model.connections) {
        for (AxisLaw& law : connection.axis) {
            law.stiffness = vary(law.stiffness);
            law.damping = 1e-3 * law.stiffness;
        }
        connection.axis[2].stops = {{Side::positive, vary(3e-4), 8e5, 0.2}, {Side::negative, vary(3e-4), 8e5, 0.0}};
    }
    model.connections[0].axis[0].friction = Friction{vary(5), 5e-3, {}};
    model.connections[1].axis[2].friction = Friction{vary(10), 1e-3, 4e5};
    model.connections[1].axis[2].hysteresis = Hysteresis{vary(10), vary(1e-4), vary(2), vary(0.7)};
    model.connections[2].axis[0].hysteresis = Hysteresis{vary(5), vary(1e-4), vary(1.5), 0.5};
    model.connections[2].axis[1].relaxation = Relaxation{vary(0.3), 0.01};
    model.connections[2].axis[2].loss_factor = vary(0.1);
    model.connections[3].axis[2].quadratic = vary(5e6);
    model.connections[3].axis[2].cubic = vary(1e10);
    model.connections[3].axis[0].drift = vary(0.1);
    return model;
}

void compare(const std::vector<MountModel>& models, const Drive& drive) {
    const std::vector<Eigen::MatrixXd> together = ForwardEnsemble(models).simulate(drive);
    REQUIRE(together.size() == models.size());
    for (std::size_t i = 0; i < models.size(); ++i) {
        const Eigen::MatrixXd alone = ForwardModel(models[i]).simulate(drive).q;
        CAPTURE(i);
        REQUIRE(together[i].cols() == alone.cols());
        CHECK(test::calcRelativeError(together[i], alone) < 1e-9);
        if (i > 0) CHECK(test::calcRelativeError(together[i], together[0]) > 1e-3);
    }
}

}  // namespace

TEST_CASE("sets side by side move as each does alone") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    const TimeGrid grid = test::makeGrid(1e-3, 201, 2);
    const std::vector<double> times = test::makeTimes(grid);
    for (const bool with_bracket : {true, false}) {
        std::vector<MountModel> models;
        for (int i = 0; i < 11; ++i) models.push_back(drawDevice(random, with_bracket));
        const Eigen::Matrix3Xd load = test::makeLoad(grid, with_bracket ? 300 : 10);
        const Eigen::Matrix3Xd none;
        compare(models, Drive::makeLoad(times, with_bracket ? load : none, with_bracket ? none : load, grid));
    }
}

TEST_CASE("sets follow a prescribed motion of the fixed part") {
    std::mt19937 random(1);
    const TimeGrid grid = test::makeGrid(1e-3, 201, 2);
    PartMotion fixed;
    for (auto* matrix : {&fixed.p, &fixed.theta, &fixed.v, &fixed.w}) matrix->setZero(3, grid.samples);
    for (int k = 0; k < grid.samples; ++k) {
        const double t = grid.sampleTime(k), omega = 120, start = std::min(1.0, t / 0.1);
        fixed.p.col(k) = Eigen::Vector3d(2e-4, 0, 1e-3) * start * start * std::sin(omega * t);
        fixed.theta.col(k) = Eigen::Vector3d(1e-3, 5e-4, 0) * start * start * std::sin(omega * t);
    }
    for (int k = 1; k + 1 < grid.samples; ++k) {
        fixed.v.col(k) = (fixed.p.col(k + 1) - fixed.p.col(k - 1)) / (2 * grid.interval);
        fixed.w.col(k) = (fixed.theta.col(k + 1) - fixed.theta.col(k - 1)) / (2 * grid.interval);
    }
    std::vector<MountModel> models;
    for (int i = 0; i < 3; ++i) models.push_back(drawDevice(random, true));
    compare(models, Drive::makeFixedMotion(test::makeTimes(grid), fixed, grid));
}

TEST_CASE("sets of other structure, held motions and divergence are told apart") {
    std::mt19937 random(2);
    const TimeGrid grid = test::makeGrid(1e-3, 201, 2);
    std::vector<MountModel> models;
    for (int i = 0; i < 5; ++i) models.push_back(drawDevice(random, true));
    models[1].connections[0].axis[2].stops.pop_back();
    models[3].body.free = {true, true, true, false, false, false};
    const Drive drive = Drive::makeLoad(test::makeTimes(grid), test::makeLoad(grid, 300), {}, grid);
    compare(models, drive);
    models[2].gravity.setZero();
    models[2].connections[3].axis[2].cubic = -1e14;
    const std::vector<Eigen::MatrixXd> result = ForwardEnsemble(models).simulate(drive);
    CHECK(result[2].size() == 0);
    CHECK(test::calcRelativeError(result[4], ForwardModel(models[4]).simulate(drive).q) < 1e-9);
}

TEST_CASE("windows of an ensemble start from the states given") {
    std::mt19937 random(3);
    const TimeGrid grid = test::makeGrid(1e-3, 201, 2);
    const Drive drive = Drive::makeLoad(test::makeTimes(grid), test::makeLoad(grid, 300), {}, grid);
    const std::vector<MountModel> models{drawDevice(random, true), drawDevice(random, true)};
    std::vector<ForwardState> states;
    std::vector<Eigen::MatrixXd> whole;
    for (const MountModel& model : models) {
        const ForwardModel forward(model);
        const Simulation run = forward.simulate(drive, Keep::states);
        states.push_back(forward.stateAt(run, drive, 80));
        whole.push_back(run.q.middleCols(80, 50));
    }
    const std::vector<Eigen::MatrixXd> windows = ForwardEnsemble(models).simulate(drive, states, 80, 50);
    for (std::size_t i = 0; i < 2; ++i) CHECK(test::calcRelativeError(windows[i], whole[i]) < 1e-6);
    CHECK_THROWS_AS(ForwardEnsemble(models).simulate(drive, states, 180, 50), std::invalid_argument);
    CHECK_THROWS_AS(ForwardEnsemble(models).simulate(drive, {states[0]}, 0, 50), std::invalid_argument);
}
