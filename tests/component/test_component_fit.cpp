#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <random>

#include "identify/component/component_fit.hpp"
#include "models/axis_law.hpp"
#include "models/common/error.hpp"
#include "models/law_equality.hpp"
#include "models/sampled_motion.hpp"
#include "tests/component/synthetic_test.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

using test::makeSyntheticTest;
using test::SyntheticTest;

MountModel makeModel(const AxisLaw& law) {
    MountModel model;
    model.body.mass = 2;
    model.body.inertia.setIdentity();
    model.connections.resize(1);
    model.connections[0].name = "1";
    model.connections[0].axis[2] = law;
    return model;
}

double findValue(const ComponentFit& fit, const std::string& name) {
    for (const auto& p : fit.parameters)
        if (p.name == name) return p.value;
    FAIL("no parameter " << name);
    return 0;
}

/// How many of the parameters' intervals hold the truth, over several draws; none may be out by more than twice the
/// half width (beyond four standard errors chance is out of the question), nor be wider than half its value.
void checkRecovery(const AxisLaw& law, const std::function<double(double, double)>& truth,
                   const std::map<std::string, double>& expected) {
    int held = 0, total = 0;
    for (unsigned seed = 1; seed <= 20; ++seed) {
        SyntheticTest test;
        test.noise = 8;
        const auto fit = fitComponent({makeSyntheticTest(truth, test, seed)}, makeModel(law), {});
        for (const auto& p : fit.parameters) {
            const auto found = expected.find(p.name);
            CAPTURE(seed, p.name, p.value, p.lower, p.upper);
            REQUIRE(found != expected.end());
            const double error = std::abs(p.value - found->second), half = 0.5 * (p.upper - p.lower);
            CHECK(error <= 2 * half);
            if (found->second != 0) CHECK(half < 0.5 * std::abs(found->second));
            held += error <= half ? 1 : 0;
            ++total;
        }
        CHECK(fit.parameters.size() == expected.size());
        CHECK(fit.not_identifiable.empty());
    }
    CAPTURE(held, total);
    // Of 100 or 140 intervals of 95 % fewer hold the truth once in 700 or 1500 times, were they independent. Those
    // that take the samples of the correlated noise for independent are 4 to 6 times too narrow and hold a quarter to
    // a third: never.
    CHECK(held >= 0.88 * total);
}

}  // namespace

TEST_CASE("Stops on both sides are recovered within their intervals") {
    AxisLaw law;
    law.stiffness = 1e5;
    law.stops = {{Side::positive, 1e-3, 1e6, 0}, {Side::negative, 1e-3, 1e6, 0}};
    checkRecovery(law,
                  [](double q, double v) {
                      return 9e4 * q + 300 * v + 12e5 * std::max(q - 1.6e-3, 0.0) + 5e5 * std::min(q + 1.3e-3, 0.0) + 4;
                  },
                  {{"1.z.stiffness", 9e4},
                   {"1.z.damping", 300},
                   {"1.z.force_offset", 4},
                   {"1.z.+.clearance", 1.6e-3},
                   {"1.z.+.stiffness", 12e5},
                   {"1.z.-.clearance", 1.3e-3},
                   {"1.z.-.stiffness", 5e5}});
}

TEST_CASE("A law that saturates is a stop of negative stiffness") {
    AxisLaw law;
    law.stiffness = 1e4;
    law.stops = {{Side::positive, 0.5e-3, -1e4, 0}, {Side::negative, 0.5e-3, -1e4, 0}};
    checkRecovery(law, [](double q, double v) { return std::clamp(3e5 * q, -300.0, 300.0) + 300 * v; },
                  {{"1.z.stiffness", 3e5},
                   {"1.z.damping", 300},
                   {"1.z.force_offset", 0},
                   {"1.z.+.clearance", 1e-3},
                   {"1.z.+.stiffness", -3e5},
                   {"1.z.-.clearance", 1e-3},
                   {"1.z.-.stiffness", -3e5}});
}

TEST_CASE("Cubic term and dry friction are recovered within their intervals") {
    AxisLaw law;
    law.cubic = 1;
    law.friction = Friction{1, 1e-3, {}};
    checkRecovery(law,
                  [](double q, double v) { return 9e4 * q + 300 * v + 2e10 * q * q * q + 30 * std::tanh(v / 1e-3); },
                  {{"1.z.stiffness", 9e4},
                   {"1.z.damping", 300},
                   {"1.z.cubic", 2e10},
                   {"1.z.friction_force", 30},
                   {"1.z.force_offset", 0}});
}

TEST_CASE("The fitted model has nothing twice: its force is the measured one") {
    AxisLaw law;
    law.stiffness = 1e5;
    law.loss_factor = 0.2;
    law.offset = 0.2e-3;
    law.relaxation = Relaxation{0.3, 0.01};
    law.hysteresis = Hysteresis{20, 1e-4, 1, 0.5};
    law.stops = {{Side::positive, 1.8e-3, 1e6, 0.4}, {Side::negative, 1.1e-3, 1e6, 0}, {Side::negative, 9e-3, 1e6, 0}};
    SyntheticTest test;
    test.noise = 2;
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    const auto recording = makeSyntheticTest(
        [](double q, double v) {
            return 9e4 * q + 300 * v + 12e5 * std::max(q - 1.6e-3, 0.0) + 5e5 * std::min(q + 1.3e-3, 0.0);
        },
        test, seed);
    const auto fit = fitComponent({recording}, makeModel(law), {});
    const AxisForce fitted(fit.fitted.connections[0].axis[2]);
    REQUIRE(fitted.stateCount() == 0);
    const auto data = extractComponent(recording, {});
    double left = 0;
    for (Eigen::Index k = 0; k < data.count(); ++k) {
        const double force = fitted.calcForce(data.q[k], data.velocity[k], data.time[k], nullptr) + fit.force_offset;
        left += std::pow(data.force[k] - force, 2) / static_cast<double>(data.count());
    }
    CHECK(std::sqrt(left) == Approx(2).epsilon(0.15));  // the noise, correlated over 40 samples
    // Never reached, but where noise looks like a bend (once in some hundred draws): the model's, from rest.
    if (!fit.not_identifiable.empty()) CHECK(fitted.law().stops[2].clearance == Approx(9.2e-3));
    CHECK(std::count_if(fit.notes.begin(), fit.notes.end(), [](const std::string& note) {
              return note.find("the model's offset, loss_factor, relaxation, hysteresis, stops.dissipation") == 0;
          }) == 1);
}

TEST_CASE("A model's curve, branches and sliders are taken as they are, and what acts beside them is fitted") {
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    AxisLaw law;
    law.curve = {{-3e-3, -200, {}}, {0, 0, {}}, {1e-3, 15, {}}, {3e-3, 20, {}}};
    law.sliders = {{30, 2e-4, 0, {}, {}}};
    SyntheticTest test;
    test.noise = 0.5;
    Recording recording = makeSyntheticTest([](double q, double v) { return 9e4 * q + 300 * v; }, test, seed);
    const ComponentData linear = extractComponent(recording, {});
    const Eigen::VectorXd known = calcForceAlong(law, linear.time, linear.q, linear.velocity);
    for (Channel& channel : recording.channels)
        if (channel.name == "force.1.z")
            for (std::size_t k = 0; k < channel.values.size(); ++k)
                channel.values[k] += known[static_cast<Eigen::Index>(k)];
    law.stiffness = 5e4;
    law.damping = 100;
    const ComponentFit fit = fitComponent({recording}, makeModel(law), {});
    CHECK(findValue(fit, "1.z.stiffness") == Approx(9e4).epsilon(0.01));
    CHECK(findValue(fit, "1.z.damping") == Approx(300).epsilon(0.05));
    CHECK(std::abs(findValue(fit, "1.z.force_offset")) < 0.5);
    CHECK(fit.fitted.connections[0].axis[2].curve == law.curve);
    CHECK(fit.residual_rms == Approx(0.5).epsilon(0.2));
}

TEST_CASE("A stop that is never reached is said to be unknown, and the model keeps its value") {
    AxisLaw law;
    law.stiffness = 1e5;
    law.stops = {{Side::positive, 8e-3, 1e6, 0}};
    SyntheticTest test;
    const auto fit = fitComponent({makeSyntheticTest([](double q, double v) { return 9e4 * q + 5 * v; }, test, 3)},
                                  makeModel(law), {});
    CHECK(findValue(fit, "1.z.stiffness") == Approx(9e4).epsilon(1e-6));
    std::vector<std::string> unknown;
    for (const auto& u : fit.not_identifiable) unknown.push_back(u.name);
    CHECK(unknown == std::vector<std::string>{"1.z.+.clearance", "1.z.+.stiffness"});
    CHECK(fit.fitted.connections[0].axis[2].stops[0].clearance == 8e-3);
}

TEST_CASE("Force from mass times acceleration has the sign of the law") {
    // A body on a spring, ringing freely: m q'' = -k q, fixed end at rest.
    const double k = 5e3, m = 2, w = std::sqrt(k / m);
    Recording recording;
    recording.file = "ringing";
    Channel q{"mobile.1.z", "m", {}, 2}, a{"mobile.1.az", "m/s^2", {}, 3};
    for (int i = 0; i < 2000; ++i) {
        recording.time.push_back(i * 1e-3);
        q.values.push_back(1e-3 * std::cos(w * i * 1e-3));
        a.values.push_back(-1e-3 * w * w * std::cos(w * i * 1e-3));
    }
    recording.channels = {q, a};
    AxisLaw law;
    law.stiffness = 1;
    const auto fit = fitComponent({recording}, makeModel(law), {});
    CHECK(findValue(fit, "1.z.stiffness") == Approx(k).epsilon(1e-6));
    ComponentOptions options;
    CHECK_THROWS_AS(extractComponent(recording, options), InputError);  // no mass, no force
    options.mass = m;
    options.from = 5.0;
    CHECK_THROWS_AS(extractComponent(recording, options), InputError);  // empty window
    options.from.reset();
    options.connection = "7";
    CHECK_THROWS_AS(extractComponent(recording, options), InputError);
}

}  // namespace wems::identify
