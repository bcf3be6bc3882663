// Springs with gap and dry friction in series, and laws along a sampled motion.
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "models/common/units.hpp"
#include "models/sampled_motion.hpp"
#include "tests/models/random_values.hpp"
#include "tests/seed.hpp"

using namespace wems;
using wems::test::RandomValues;

namespace {

AxisForce makeForce(const std::vector<Slider>& sliders) {
    AxisLaw law;
    law.sliders = sliders;
    return AxisForce(law);
}

/// Spring, gap and friction as a mechanism: the friction's place is moved by what stretches the spring beyond Y.
class Mechanism {
public:
    explicit Mechanism(const Slider& slider) : slider_(slider) {}
    double move(double q) {
        const double stretch = q - place_, limit = slider_.yield_displacement + 0.5 * slider_.gap;
        if (stretch > limit) place_ = q - limit;
        if (stretch < -limit) place_ = q + limit;
        const double e = q - place_, half = 0.5 * slider_.gap, yield = slider_.yield_displacement;
        if (e > half) return slider_.force * (e - half) / yield;
        if (e < -half) return slider_.negative_force.value_or(slider_.force) * (e + half) / yield;
        return 0;
    }

private:
    Slider slider_;
    double place_ = 0;
};

/// Work (J) done on the law along a travel in one direction, by Simpson's rule.
double calcWork(const AxisForce& force, double travel, double& e) {
    constexpr int pieces = 2000;
    const double h = travel / pieces;
    double work = 0;
    for (int i = 0; i < pieces; ++i) {
        const double before = force.calcForce(0, 0, 0, &e);
        force.dragStates(h / 2, &e);
        const double middle = force.calcForce(0, 0, 0, &e);
        force.dragStates(h / 2, &e);
        work += h / 6 * (before + 4 * middle + force.calcForce(0, 0, 0, &e));
    }
    return work;
}

}  // namespace

TEST_CASE("drag along: a cubic that turns is dragged there and back") {
    AxisLaw law;
    law.friction = Friction{2.0, 1e-3, 1e6};  // 2 N, bristle of 1 N/um: slides from 2 um on
    const AxisForce force(law);
    const double sliding = 2e-6;
    const auto follow = [&](double from, double travel, double direction) {  // s' = v (1 − direction s / (F/σ))
        return direction * sliding + (from - direction * sliding) * std::exp(-std::abs(travel) / sliding);
    };
    // q = a (s − s²) over the unit interval: up by a/4 and back.
    for (const double a : {1e-6, 4e-6, 4e-5}) {
        AxisInterval step{0, a, 0, -a, 1};
        double z = 0;
        dragAlong(force, step, &z);
        CAPTURE(a);
        CHECK(z == Approx(follow(follow(0, a / 4, 1), a / 4, -1)).margin(1e-12));
        step.v1 = a;  // no turn: the ends alone count, and they are the same
        z = 0.5e-6;
        dragAlong(force, step, &z);
        CHECK(z == Approx(0.5e-6));
    }
}

TEST_CASE("a slider with a corner is the mechanism of spring, gap and friction") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    RandomValues random(seed);
    for (int i = 0; i < 50; ++i) {
        Slider slider = random.slider();
        slider.exponent.reset();
        const AxisForce force = makeForce({slider});
        REQUIRE(force.stateCount() == 1);
        Mechanism mechanism(slider);
        double q = 0, e = 0;
        for (int leg = 0; leg < 30; ++leg) {
            const double travel = random.number(-3, 3) * (slider.yield_displacement + slider.gap);
            force.dragStates(travel, &e);
            q += travel;
            CHECK(force.calcForce(q, 0.1, 0, &e) == Approx(mechanism.move(q)).margin(1e-9 * slider.force));
        }
    }
}

TEST_CASE("a slider without gap is the hysteresis whose reversals cost nothing") {
    const AxisForce slider = makeForce({Slider{40, 2e-4, 0, {}, 3.0}});
    AxisLaw law;
    law.hysteresis = Hysteresis{40, 2e-4, 3, 0.5};
    const AxisForce hysteresis(law);
    RandomValues random(3);
    double e = 0, s = 0;
    for (int i = 0; i < 100; ++i) {
        const double travel = random.number(-6e-4, 6e-4);
        slider.dragStates(travel, &e);
        hysteresis.dragStates(travel, &s);
        CHECK(slider.calcForce(0, 0, 0, &e) == Approx(hysteresis.calcForce(0, 0, 0, &s)).margin(1e-12));
    }
    CHECK(slider.draggedStiffness() == Approx(2e5));
    const AxisForce gap = makeForce({Slider{40, 2e-4, 1e-3, 50.0, {}}});
    CHECK(gap.draggedStiffness() == 0);
    CHECK(gap.draggedStiffness(true) == Approx(50 / 2e-4));
}

TEST_CASE("closed cycles of a slider never give energy, and lose the area of the loop") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    RandomValues random(seed);
    for (int i = 0; i < 60; ++i) {
        const Slider slider = random.slider();
        const AxisForce force = makeForce({slider});
        const double size = slider.yield_displacement + slider.gap;
        std::vector<double> legs;  // the last one closes the cycle
        double sum = 0;
        for (int leg = random.integer(1, 6); leg > 0; --leg) {
            legs.push_back(random.number(-3, 3) * size);
            sum += legs.back();
        }
        legs.push_back(-sum);
        double e = 0, all = 0;
        for (int cycle = 0; cycle < 5; ++cycle) {
            for (const double leg : legs) all += calcWork(force, leg, e);
            CHECK(all >= -1e-5 * slider.force * size);
        }
        const double s = random.number(-1, 1) * (slider.yield_displacement + 0.5 * slider.gap);
        CHECK(force.calcDissipatedPower(0, random.number(-1, 1), 0, &s) >= 0);
    }
    // Levels 30 and 50 N, gap 1 mm, spring 0.2 mm, strokes of 2 · 5 mm: F₊ (2 A − g − Y) and the same of F₋, less the
    // triangles of the rises.
    const AxisForce force = makeForce({Slider{30, 2e-4, 1e-3, 50.0, {}}});
    double e = 0, loop = 0;
    for (int cycle = 0; cycle < 2; ++cycle) loop = calcWork(force, 1e-2, e) + calcWork(force, -1e-2, e);
    // Of a stroke of 10 mm the release takes 0.2 mm, the gap 1 mm, the rise 0.2 mm: sliding 8.6 mm. Release and rise
    // of the springs give and take the same.
    CHECK(loop == Approx(80 * 8.6e-3).epsilon(1e-3));
}

TEST_CASE("many sliders in parallel soften with the amplitude as Masing's rule says") {
    // A backbone of three corners; after a reversal the curve is the backbone twice as large.
    const std::vector<Slider> sliders{{10, 1e-4, 0, {}, {}}, {12, 3e-4, 0, {}, {}}, {8, 9e-4, 0, {}, {}}};
    const AxisForce force = makeForce(sliders);
    const auto backbone = [&](double q) {
        double f = 0;
        for (const Slider& s : sliders) f += s.force * std::min(1.0, q / s.yield_displacement);
        return f;
    };
    double z[3] = {0, 0, 0};
    const double top = 7e-4;
    force.dragStates(top, z);
    CHECK(force.calcForce(top, 0, 0, z) == Approx(backbone(top)));
    for (int i = 1; i <= 14; ++i) {
        force.dragStates(-1e-4, z);
        CHECK(force.calcForce(0, 0, 0, z) == Approx(backbone(top) - 2 * backbone(0.5e-4 * i)));
    }
}

TEST_CASE("a Prony series along a sine has its storage and loss modulus") {
    AxisLaw law;
    law.stiffness = 1e4;
    law.branches = {{5e3, 0.02}, {8e3, 0.2}, {2e3, 3.0}};
    const double amplitude = 1e-3, omega = kTwoPi * 2, interval = 1e-4;
    const Eigen::Index count = 300000;
    Eigen::VectorXd time(count), q(count), v(count);
    for (Eigen::Index k = 0; k < count; ++k) {
        time[k] = interval * static_cast<double>(k);
        q[k] = amplitude * std::sin(omega * time[k]);
        v[k] = amplitude * omega * std::cos(omega * time[k]);
    }
    const Eigen::VectorXd f = calcForceAlong(law, time, q, v);
    double storage = 0, loss = 0, expected_storage = 1e4, expected_loss = 0;
    const Eigen::Index from = count - 20000;  // four periods
    for (Eigen::Index k = from; k < count; ++k) {
        storage += f[k] * std::sin(omega * time[k]) / 10000 / amplitude;
        loss += f[k] * std::cos(omega * time[k]) / 10000 / amplitude;
    }
    for (const MaxwellBranch& b : law.branches) {
        const double u = omega * b.time_constant;
        expected_storage += b.stiffness * u * u / (1 + u * u);
        expected_loss += b.stiffness * u / (1 + u * u);
    }
    CHECK(storage == Approx(expected_storage).epsilon(1e-4));
    CHECK(loss == Approx(expected_loss).epsilon(1e-4));
}

TEST_CASE("along a coarsely sampled motion a slider turns where the motion does") {
    // 12 samples a period: what is dragged turns between samples. Against 40 times as many.
    AxisLaw law;
    law.sliders = {{20, 1e-4, 0, {}, {}}, {30, 4e-4, 5e-4, {}, {}}};
    const auto simulate = [&](int samples) {
        const Eigen::Index count = 10 * static_cast<Eigen::Index>(samples) + 1;
        Eigen::VectorXd time(count), q(count), v(count);
        for (Eigen::Index k = 0; k < count; ++k) {
            time[k] = static_cast<double>(k) / samples;
            const double phase = kTwoPi * time[k] + 0.7;
            q[k] = 1e-3 * (std::sin(phase) - std::sin(0.7));
            v[k] = 1e-3 * kTwoPi * std::cos(phase);
        }
        return calcForceAlong(law, time, q, v);
    };
    const Eigen::VectorXd coarse = simulate(12), fine = simulate(480);
    double worst = 0;
    for (Eigen::Index k = 0; k < coarse.size(); ++k) worst = std::max(worst, std::abs(coarse[k] - fine[40 * k]));
    CHECK(worst < 0.01 * 50);  // the cubic's own error: 0.3 % of the amplitude at 12 samples
}
