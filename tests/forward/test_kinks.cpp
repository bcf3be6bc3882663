// Where steps are cut, and what that gives: exact motions through stops and bristles, order of convergence.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/forward/kinks.hpp"
#include "models/common/units.hpp"
#include "tests/forward/forward_fixture.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

using Step = AxisStep<double>;

/// A step of the cubic c0 + c1 t + c2 t² + c3 t³.
Step makeStep(const double (&c)[4], double h) {
    const auto q = [&](double t) { return c[0] + t * (c[1] + t * (c[2] + t * c[3])); };
    const auto v = [&](double t) { return c[1] + t * (2 * c[2] + t * 3 * c[3]); };
    return {q(0), v(0), q(h), v(h), h};
}

/// The oscillator of 2 kg and 2e4 N/m with a stop of its own on each side, set off from the middle.
MountModel makeImpactOscillator(double stop_stiffness, double clearance) {
    MountModel model = test::makeOscillator();
    model.connections[0].axis[2].stops = {{Side::positive, clearance, stop_stiffness, 0.0},
                                          {Side::negative, clearance, stop_stiffness, 0.0}};
    return model;
}

Eigen::RowVectorXd simulateFree(const MountModel& model, const TimeGrid& grid, double velocity) {
    const ForwardModel forward(model);
    const Drive drive = Drive::makeFree(grid);
    ForwardState state = forward.restState();
    state.mobile.v_GM.z() = velocity;
    return forward.simulate(drive, state, 0, grid.samples).q.row(2);
}

/// Exact motion of that oscillator: sines between the contacts.
double calcExact(double t, double velocity, double clearance, double free, double closed) {
    // From the middle to the stop, in contact, and back: then the same on the other side.
    const double to_stop = std::asin(clearance * free / velocity) / free;
    const double at_stop = velocity * std::cos(free * to_stop);
    // In contact x = m + A sin(closed τ + φ) about the middle m of both springs together.
    const double middle = clearance * (1 - free * free / (closed * closed));
    const double phase = std::atan2((clearance - middle) * closed, at_stop);
    const double amplitude = std::hypot(clearance - middle, at_stop / closed);
    const double in_contact = (kTwoPi / 2 - 2 * phase) / closed;
    const double half_period = 2 * to_stop + in_contact;
    const double halves = std::floor(t / half_period);
    const double sign = std::fmod(halves, 2) == 0 ? 1 : -1;
    const double within = t - halves * half_period;
    if (within < to_stop) return sign * velocity / free * std::sin(free * within);
    if (within < to_stop + in_contact)
        return sign * (middle + amplitude * std::sin(closed * (within - to_stop) + phase));
    return sign * velocity / free * std::sin(free * (half_period - within));
}

/// The error under a load of 300 N with two steps a sample, and how it falls with eight, both against 64.
void checkFallsFasterThanSecondPower(const MountModel& model) {
    const ForwardModel forward(model);
    const auto run = [&](int steps) {
        const TimeGrid grid = test::makeGrid(1e-3, 401, steps);
        return forward.simulate(Drive::makeLoad(test::makeTimes(grid), test::makeLoad(grid, 300), {}, grid)).q;
    };
    const Eigen::MatrixXd reference = run(64);
    const double two = test::calcRelativeError(run(2), reference), eight = test::calcRelativeError(run(8), reference);
    CAPTURE(two, eight);
    CHECK(two < 1e-4);
    CHECK(std::log2(two / eight) / 2 > 2);
}

}  // namespace

TEST_CASE("the first root of a cubic in a step is found") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> draw(0.02, 0.98);
    for (int i = 0; i < 200; ++i) {
        const double h = 1e-3, root = h * draw(random), scale = 1 + draw(random);
        // (t − root)(t² + b t + c) with complex other roots: one crossing.
        const double b = h * (draw(random) - 0.5), c = b * b / 4 + h * h * draw(random);
        const double cubic[4] = {-scale * root * c, scale * (c - root * b), scale * (b - root), scale};
        const Step step = makeStep(cubic, h);
        CHECK(findStopKink(step, 1.0, 0.0, false) == Approx(root / h).epsilon(1e-9));
        CHECK(findStopKink(step, -1.0, 0.0, true) == Approx(root / h).epsilon(1e-9));
    }
    // Through and back within one step; touching from inside only.
    const Step dip = makeStep({0.24, -1.0, 1.0, 0.0}, 1.0);
    CHECK(findStopKink(dip, 1.0, 0.0, true) == Approx(0.4));
    CHECK(findStopKink(dip, 1.0, 0.02, true) == no_kink);
    // A reversal, and one that the bristle does not notice.
    const Step turn = makeStep({0.0, 1.0, -1.0, 0.0}, 1.0);
    CHECK(findReversal(turn, 1.0, 0.1, 0.1) == Approx(0.5));
    CHECK(findReversal(turn, 1.0, 1000.0, 0.1) == no_kink);
}

TEST_CASE("an oscillator between stops moves as the exact solution does") {
    const double clearance = 1e-3, velocity = 0.3, free = 100, closed = std::sqrt((2e4 + 2e5) / 2);
    const MountModel model = makeImpactOscillator(2e5, clearance);
    double before = 0;
    for (int steps : {1, 2, 4}) {
        const TimeGrid grid = test::makeGrid(1e-3, 1001, steps);  // about 55 contacts
        const Eigen::RowVectorXd q = simulateFree(model, grid, velocity);
        double worst = 0;
        for (int k = 0; k < grid.samples; ++k)
            worst = std::max(worst, std::abs(q[k] - calcExact(grid.sampleTime(k), velocity, clearance, free, closed)));
        CAPTURE(steps, worst, before);
        if (steps == 4) CHECK(worst < 1e-3 * clearance);
        if (steps > 1) CHECK(std::log2(before / worst) > 3.5);
        before = worst;
    }
}

TEST_CASE("contact that lasts less than a step is met") {
    // Would turn 1e-6 m behind the stop without it: in contact for less than a step.
    const double free = 100, clearance = 1e-3;
    const double velocity = free * (clearance + 1e-6);
    const MountModel model = makeImpactOscillator(2e6, clearance);
    const auto run = [&](int steps) { return simulateFree(model, test::makeGrid(8e-4, 1251, steps), velocity); };
    const Eigen::RowVectorXd fine = run(64);
    const double one = (run(1) - fine).cwiseAbs().maxCoeff(), four = (run(4) - fine).cwiseAbs().maxCoeff();
    CAPTURE(one, four);
    CHECK(four < 1e-3 * clearance);
    CHECK(std::log2(one / four) / 2 > 3.5);
}

TEST_CASE("sliding with presliding friction is right however fast") {
    // A free body that drags one bristle, stretched as far as it goes: a constant force until the body turns, then the
    // bristle swings it. The rate of the bristle's stretch is 1e5 1/s, where 2.8 / h would be stable.
    MountModel model = test::makeOscillator();
    AxisLaw& law = model.connections[0].axis[2];
    law.stiffness = 0;
    const double force = 10, bristle = 1e6, velocity = 1.0, mass = model.body.mass;
    law.friction = Friction{force, 1e-3, bristle};
    const ForwardModel forward(model);
    const TimeGrid grid = test::makeGrid(1e-3, 301, 1);
    const Drive drive = Drive::makeFree(grid);
    ForwardState state = forward.restState();
    state.mobile.v_GM.z() = velocity;
    state.internal[0] = force / bristle;
    const Simulation run = forward.simulate(drive, state, 0, grid.samples, Keep::states);
    for (int k : {10, 50, 100, 199}) {
        const double t = grid.sampleTime(k), slowing = force / mass;
        CHECK(forward.stateAt(run, drive, k).mobile.v_GM.z() == Approx(velocity - slowing * t).margin(1e-12));
        CHECK(run.q(2, k) == Approx(velocity * t - slowing * t * t / 2));
        CHECK(forward.stateAt(run, drive, k).internal[0] == Approx(force / bristle));
    }
    // Never more energy than before, and less in the end: each swing past the turning point costs some.
    for (int k = 1; k < grid.samples; ++k)
        CHECK(forward.calcEnergy(run, drive, k) <= forward.calcEnergy(run, drive, k - 1) + 1e-5);
    CHECK(forward.calcEnergy(run, drive, 300) < forward.calcEnergy(run, drive, 205));
}

TEST_CASE("with presliding friction the error falls faster than with the second power of the step") {
    MountModel model = test::makeCross();
    model.bracket = test::makeBracketModes();
    for (Connection& connection : model.connections) {
        for (AxisLaw& law : connection.axis) law.damping = 1e-3 * law.stiffness;
        connection.axis[2].friction = Friction{15, 1e-3, 4e5};
        connection.axis[2].stops = {{Side::positive, 2e-4, 8e5, 0.2}, {Side::negative, 2e-4, 8e5, 0.2}};
    }
    checkFallsFasterThanSecondPower(model);
}

TEST_CASE("sliding with hysteresis is right however fast") {
    // As above with a sharp knee: the rate at the level is n v / Y = 1e6 1/s.
    MountModel model = test::makeOscillator();
    AxisLaw& law = model.connections[0].axis[2];
    law.stiffness = 0;
    const double force = 10, yield = 1e-5, velocity = 1.0, mass = model.body.mass;
    law.hysteresis = Hysteresis{force, yield, 10, 0.5};
    const ForwardModel forward(model);
    const TimeGrid grid = test::makeGrid(1e-3, 301, 1);
    const Drive drive = Drive::makeFree(grid);
    ForwardState state = forward.restState();
    state.mobile.v_GM.z() = velocity;
    state.internal[0] = yield;
    const Simulation run = forward.simulate(drive, state, 0, grid.samples, Keep::states);
    for (int k : {10, 50, 100, 199}) {
        const double t = grid.sampleTime(k), slowing = force / mass;
        CHECK(forward.stateAt(run, drive, k).mobile.v_GM.z() == Approx(velocity - slowing * t).margin(1e-12));
        CHECK(run.q(2, k) == Approx(velocity * t - slowing * t * t / 2));
        CHECK(forward.stateAt(run, drive, k).internal[0] == Approx(yield));
    }
    for (int k = 1; k < grid.samples; ++k)
        CHECK(forward.calcEnergy(run, drive, k) <= forward.calcEnergy(run, drive, k - 1) + 1e-5);
}

TEST_CASE("with hysteresis the error falls faster than with the second power of the step") {
    MountModel model = test::makeCross();
    model.bracket = test::makeBracketModes();
    for (Connection& connection : model.connections) {
        for (AxisLaw& law : connection.axis) law.damping = 1e-3 * law.stiffness;
        connection.axis[2].hysteresis = Hysteresis{15, 5e-5, 2, 0.5};
        connection.axis[0].hysteresis = Hysteresis{3, 5e-5, 1, 0.7};
    }
    checkFallsFasterThanSecondPower(model);
}
