// The hysteresis of Bouc and Wen against its own published equation, closed forms, and what energy allows.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "models/axis_law.hpp"
#include "tests/models/random_values.hpp"
#include "tests/seed.hpp"

using namespace wems;
using wems::test::RandomValues;

namespace {

AxisForce makeForce(const Hysteresis& hysteresis) {
    AxisLaw law;
    law.hysteresis = hysteresis;
    return AxisForce(law);
}

Hysteresis drawHysteresis(RandomValues& random) {
    return {random.number(1, 50), random.number(5e-5, 5e-4), random.number(1, 10), random.number(0.5, 1)};
}

/// Wen's equation as published, for z from −1 to 1, by Runge and Kutta with fine steps of the travel.
double followWen(const Hysteresis& law, double z, double travel) {
    const double beta = law.shape, gamma = 1 - beta;
    const int steps = 20 + static_cast<int>(200 * law.exponent * std::abs(travel) / law.yield_displacement);
    const double h = std::abs(travel) / steps, v = travel < 0 ? -1 : 1;
    const auto rate = [&](double at) {
        const double power = std::pow(std::abs(at), law.exponent - 1);
        return (v - beta * std::abs(v) * power * at - gamma * v * power * std::abs(at)) / law.yield_displacement;
    };
    for (int i = 0; i < steps; ++i) {
        const double k1 = rate(z), k2 = rate(z + h / 2 * k1), k3 = rate(z + h / 2 * k2), k4 = rate(z + h * k3);
        z += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    return z;
}

/// Work done on the law (J) along a travel in one direction, by Simpson's rule.
double calcWork(const AxisForce& force, double travel, double& s) {
    constexpr int pieces = 200;
    const double h = travel / pieces;
    double work = 0;
    for (int i = 0; i < pieces; ++i) {
        const double before = force.calcForce(0, 0, 0, &s);
        force.dragStates(h / 2, &s);
        const double middle = force.calcForce(0, 0, 0, &s);
        force.dragStates(h / 2, &s);
        work += h / 6 * (before + 4 * middle + force.calcForce(0, 0, 0, &s));
    }
    return work;
}

}  // namespace

TEST_CASE("hysteresis follows Wen's equation, however its travel is cut") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    RandomValues random(seed);
    for (int i = 0; i < 60; ++i) {
        const Hysteresis law = drawHysteresis(random);
        CAPTURE(law.exponent, law.shape, law.yield_displacement);
        const AxisForce force = makeForce(law);
        REQUIRE(force.stateCount() == 1);
        double z = random.number(-1, 1), s = z * law.yield_displacement;
        for (int leg = 0; leg < 8; ++leg) {
            const double travel = random.number(-3, 3) * law.yield_displacement;
            CAPTURE(leg, travel, z);
            z = followWen(law, z, travel);
            const int cuts = random.integer(1, 5);
            for (int cut = 0; cut < cuts; ++cut) force.dragStates(travel / cuts, &s);
            CHECK(s / law.yield_displacement == Approx(z).margin(1e-4));
            CHECK(force.calcForce(0.01, 0.3, 0, &s) == Approx(law.force * z).margin(1e-4 * law.force));
        }
    }
}

TEST_CASE("the rate of the hysteresis is the derivative of its path") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    RandomValues random(seed);
    for (int i = 0; i < 100; ++i) {
        const Hysteresis law = drawHysteresis(random);
        const AxisForce force = makeForce(law);
        const double s = random.number(-0.98, 0.98) * law.yield_displacement, v = random.number(-1, 1);
        const double dt = 1e-4 * law.yield_displacement / std::abs(v);
        double once = s, twice = s, rate = 0;
        force.dragStates(v * dt, &once);
        force.dragStates(2 * v * dt, &twice);
        force.calcStateDerivative(0, v, &s, &rate);
        CHECK(rate == Approx((4 * once - twice - 3 * s) / (2 * dt)).epsilon(1e-5).margin(1e-5 * std::abs(v)));
    }
}

TEST_CASE("with n = 1 and all loss in reversal hysteresis is presliding friction") {
    const double level = 12, yield = 1.2e-4;
    AxisLaw friction;
    friction.friction = Friction{level, 1e-3, level / yield};
    const AxisForce dahl(friction), force = makeForce({level, yield, 1, 1});
    RandomValues random(7);
    double s = 0, z = 0, s_rate = 0, z_rate = 0;
    for (int i = 0; i < 100; ++i) {
        const double travel = random.number(-4, 4) * yield, v = random.number(-1, 1);
        dahl.dragStates(travel, &s);
        force.dragStates(travel, &z);
        CHECK(z == Approx(s).margin(1e-12 * yield));
        dahl.calcStateDerivative(0, v, &s, &s_rate);
        force.calcStateDerivative(0, v, &z, &z_rate);
        CHECK(z_rate == Approx(s_rate).margin(1e-12));
        CHECK(force.calcDissipatedPower(0, v, 0, &z) == Approx(dahl.calcDissipatedPower(0, v, 0, &s)));
    }
}

TEST_CASE("with n = 2 loading is a hyperbolic tangent and unloading a line") {
    const double level = 40, yield = 2e-4;
    const AxisForce force = makeForce({level, yield, 2, 0.5});
    double s = 0;
    for (int i = 1; i <= 30; ++i) {
        force.dragStates(0.1 * yield, &s);
        CHECK(force.calcForce(0, 0, 0, &s) == Approx(level * std::tanh(0.1 * i)).margin(1e-6 * level));
    }
    const double top = s;
    for (int i = 1; i <= 9; ++i) {
        force.dragStates(-0.1 * yield, &s);
        CHECK(s == Approx(top - 0.1 * i * yield));
    }
}

TEST_CASE("a sharp knee is a spring up to the level, and any hysteresis one for small strokes") {
    const double level = 40, yield = 2e-4;
    const AxisForce sharp = makeForce({level, yield, Hysteresis::sharpest, 0.5});
    CHECK(sharp.draggedStiffness() == Approx(level / yield));
    double s = 0, furthest = 0;
    for (int i = 1; i <= 40; ++i) {
        sharp.dragStates(0.05 * yield, &s);
        const double ideal = level * std::min(1.0, 0.05 * i), force = sharp.calcForce(0, 0, 0, &s);
        if (i <= 16) CHECK(force == Approx(ideal).epsilon(1e-5));
        CHECK(force <= level * (1 + 1e-12));
        furthest = std::max(furthest, (ideal - force) / level);
    }
    CAPTURE(furthest);
    CHECK(furthest > 0.01);
    CHECK(furthest < 0.014);
    for (const double exponent : {1.0, 1.5, 2.0, 5.0}) {
        const AxisForce force = makeForce({level, yield, exponent, 0.8});
        double small = 0;
        force.dragStates(1e-5 * yield, &small);
        CHECK(force.calcForce(0, 0, 0, &small) == Approx(level * 1e-5).epsilon(2e-5));
    }
}

TEST_CASE("hysteresis slides at its level both ways, however far and in however few steps") {
    RandomValues random(11);
    for (int i = 0; i < 40; ++i) {
        const Hysteresis law = drawHysteresis(random);
        const AxisForce force = makeForce(law);
        double s = random.number(-1, 1) * law.yield_displacement;
        for (const double travel : {1.0, -1.0, 1e3, -30.0}) {  // yield displacements
            force.dragStates((travel < 0 ? -25 : 25) * law.yield_displacement, &s);
            force.dragStates(travel * law.yield_displacement, &s);
            const double sign = travel < 0 ? -1 : 1;
            CHECK(force.calcForce(0, 0, 0, &s) == Approx(sign * law.force).epsilon(1e-9));
        }
    }
}

TEST_CASE("closed cycles of hysteresis never give energy") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    RandomValues random(seed);
    for (int i = 0; i < 100; ++i) {
        const Hysteresis law = drawHysteresis(random);
        CAPTURE(law.exponent, law.shape, law.yield_displacement);
        const AxisForce force = makeForce(law);
        std::vector<double> legs;  // the last one closes the cycle
        double sum = 0;
        for (int leg = random.integer(1, 6); leg > 0; --leg) {
            legs.push_back(random.number(-2, 2) * law.yield_displacement * std::pow(10, random.number(-2, 0.5)));
            sum += legs.back();
        }
        legs.push_back(-sum);
        // From rest, where nothing is stored: no closed cycle gives energy, however often it is repeated.
        double s = 0, all = 0, last = 0, before = 0;
        const double scale = law.force * law.yield_displacement;
        for (int cycle = 0; cycle < 300; ++cycle) {
            before = s;
            last = 0;
            for (const double leg : legs) last += calcWork(force, leg, s);
            all += last;
            CHECK(all >= -1e-6 * scale);
            if (cycle > 2 && std::abs(s - before) < 1e-9 * law.yield_displacement) break;
        }
        // And a cycle that closes in its state too has lost what was put in.
        if (std::abs(s - before) < 1e-9 * law.yield_displacement) CHECK(last >= -1e-6 * scale);
    }
}

TEST_CASE("energy is never made at any instant if and only if shape is at least one half") {
    const auto leastPower = [](double shape) {
        const AxisForce force = makeForce({10, 1e-4, 2, shape});
        double least = 1;
        for (double s = -1e-4; s <= 1e-4; s += 1e-6)
            for (const double v : {-0.2, 0.2}) least = std::min(least, force.calcDissipatedPower(0, v, 0, &s));
        return least;
    };
    CHECK(leastPower(0.5) >= 0);
    CHECK(leastPower(0.75) >= 0);
    CHECK(leastPower(1.0) >= 0);
    // F |w|³ (2 β − 1) |v| at w = −1.
    CHECK(leastPower(0.4) == Approx(10 * -0.2 * 0.2));
}

TEST_CASE("the loop of a large stroke has the area of its level and elastic turn") {
    // Unloading along the line of the spring and a sharp knee: the parallelogram 4 F (A − Y).
    const double level = 40, yield = 2e-4, amplitude = 2e-3;
    const AxisForce force = makeForce({level, yield, Hysteresis::sharpest, 0.5});
    double s = 0, loop = 0;
    for (int cycle = 0; cycle < 2; ++cycle) {
        loop = calcWork(force, -2 * amplitude, s);
        loop += calcWork(force, 2 * amplitude, s);
    }
    CHECK(loop == Approx(4 * level * (amplitude - yield)).epsilon(0.01));
}
