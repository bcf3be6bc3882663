#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "models/axis_law.hpp"
#include "tests/models/random_values.hpp"

using namespace wems;
using wems::test::RandomValues;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

std::vector<double> randomStates(const AxisForce& force, RandomValues& random) {
    std::vector<double> z(force.stateCount());
    for (double& state : z) state = random.number(-1e-3, 1e-3);
    if (force.law().friction && force.law().friction->presliding_stiffness) {  // |σ s| ≤ F
        const double limit = force.law().friction->force / *force.law().friction->presliding_stiffness;
        z[force.branches().size()] = random.number(-limit, limit);
    }
    const std::vector<Slider>& sliders = force.law().sliders;
    auto last = z.end() - static_cast<std::ptrdiff_t>(sliders.size());
    if (force.law().hysteresis) *std::prev(last) = force.law().hysteresis->yield_displacement * random.number(-1, 1);
    for (const Slider& slider : sliders)
        *last++ = (slider.yield_displacement + 0.5 * slider.gap) * random.number(-1, 1);
    return z;
}

}  // namespace

TEST_CASE("trilinear law is the published one, by hand") {
    AxisLaw law;
    law.stiffness = 1000;
    law.stops = {{Side::positive, 0.002, 5000, 0}, {Side::negative, 0.001, 7000, 0}};
    const AxisForce force(law);
    REQUIRE(force.stateCount() == 0);
    CHECK(force.calcForce(0.0015, 0.3, 1, nullptr) == Approx(1.5));
    CHECK(force.calcForce(0.003, 0.3, 1, nullptr) == Approx(3 + 5));
    CHECK(force.calcForce(-0.002, 0.3, 1, nullptr) == Approx(-2 - 7));
    CHECK(force.calcStaticForce(-0.002) == Approx(-9));
}

TEST_CASE("a quadratic term is stiffer on one side than on the other, by hand") {
    AxisLaw law;
    law.stiffness = 1000;
    law.quadratic = 2e5;
    law.cubic = 1e8;
    const AxisForce force(law);
    CHECK(force.calcForce(1e-3, 0, 0, nullptr) == Approx(1 + 0.2 + 0.1));
    CHECK(force.calcForce(-1e-3, 0, 0, nullptr) == Approx(-1 + 0.2 - 0.1));
    CHECK(force.calcStaticForce(-1e-3) == Approx(-0.9));
    CHECK(force.calcStiffness(1e-3, 0, 0, nullptr) - force.calcStiffness(-1e-3, 0, 0, nullptr) ==
          Approx(4 * 2e5 * 1e-3));
    CHECK(force.calcPotential(-1e-3, 0, nullptr) == Approx(1e-3 * (0.5 - 0.2 / 3 + 0.1 / 4)));
}

TEST_CASE("an offset shifts both sides of the gap") {
    AxisLaw law;
    law.offset = 3e-4;
    law.stops = {{Side::positive, 1e-3, 1e6, 0}, {Side::negative, 1e-3, 1e6, 0}};
    const AxisForce force(law);
    // Clearances c+ − o = 0.7 mm and c− + o = 1.3 mm.
    CHECK(force.calcForce(0.6999e-3, 0, 0, nullptr) == 0);
    CHECK(force.calcForce(0.8e-3, 0, 0, nullptr) == Approx(100));
    CHECK(force.calcForce(-1.2999e-3, 0, 0, nullptr) == 0);
    CHECK(force.calcForce(-1.4e-3, 0, 0, nullptr) == Approx(-100));
}

TEST_CASE("a dissipating stop never pulls and is continuous at the gap") {
    AxisLaw law;
    law.stops = {{Side::positive, 1e-3, 1e6, 2.0}, {Side::negative, 1e-3, 1e6, 2.0}};
    const AxisForce force(law);
    for (double v = -3; v <= 3; v += 0.125) {
        CAPTURE(v);
        CHECK(force.calcForce(1.4e-3, v, 0, nullptr) >= 0);
        CHECK(force.calcForce(-1.4e-3, v, 0, nullptr) <= 0);
        CHECK(std::abs(force.calcForce(1e-3 + 1e-12, v, 0, nullptr)) < 1e-5);
        CHECK(force.calcForce(1e-3, v, 0, nullptr) == 0);
    }
    // k_s δ (1 + χ δ') with δ = 0.4 mm.
    CHECK(force.calcForce(1.4e-3, 0.25, 0, nullptr) == Approx(400 * 1.5));
    CHECK(force.calcForce(-1.4e-3, 0.25, 0, nullptr) == Approx(-400 * 0.5));
}

TEST_CASE("drift scales the stiffness with time") {
    AxisLaw law;
    law.stiffness = 1000;
    law.drift = 0.01;
    CHECK(AxisForce(law).calcForce(1e-3, 0, 20, nullptr) == Approx(1.2));
}

TEST_CASE("friction slides at its force and has the slope F / v_t at rest") {
    AxisLaw law;
    law.friction = Friction{12, 1e-3, {}};
    const AxisForce force(law);
    CHECK(force.calcForce(0, 0.1, 0, nullptr) == Approx(12));
    CHECK(force.calcForce(0, -0.1, 0, nullptr) == Approx(-12));
    CHECK(force.calcForce(0, 1e-6, 0, nullptr) == Approx(12e-3).epsilon(1e-5));
}

TEST_CASE("presliding friction starts as a spring and saturates at its force") {
    AxisLaw law;
    law.friction = Friction{12, 1e-3, 1e5};
    const AxisForce force(law);
    REQUIRE(force.stateCount() == 1);
    // s' = v (1 − σ s / F) at constant v > 0 has s = F/σ (1 − exp(−σ q / F)): integrate by the midpoint rule.
    double s = 0, q = 0, sdot = 0;
    const double v = 0.01, dt = 1e-6;
    for (int i = 0; i < 100000; ++i) {
        force.calcStateDerivative(q, v, &s, &sdot);
        double middle = s + 0.5 * dt * sdot;
        force.calcStateDerivative(q, v, &middle, &sdot);
        s += dt * sdot;
        q += dt * v;
        if (i % 1000 == 0)
            CHECK(force.calcForce(q, v, 0, &s) == Approx(12 * (1 - std::exp(-1e5 * q / 12))).epsilon(1e-6));
    }
    CHECK(force.calcForce(q, v, 0, &s) == Approx(12).epsilon(1e-3));
}

TEST_CASE("friction with presliding but no force exerts nothing") {
    AxisLaw law;
    law.friction = Friction{0, 1e-3, 1e5};
    const AxisForce force(law);
    double s = 0, sdot = not_a_number;
    force.calcStateDerivative(1e-3, 0.1, &s, &sdot);
    CHECK(sdot == 0);
    CHECK(force.calcForce(1e-3, 0.1, 0, &s) == 0);
}

TEST_CASE("derivatives agree with finite differences, on both sides of each kink") {
    const unsigned seed = GENERATE(range(1U, 40U));
    CAPTURE(seed);
    RandomValues random(seed);
    const AxisForce force(random.law());
    const std::vector<double> z = randomStates(force, random);
    const double t = random.number(0, 50), v = random.number(-0.3, 0.3);
    std::vector<double> places = {random.number(-4e-3, 4e-3)};
    for (const Stop& stop : force.law().stops) {
        const double kink = (stop.side == Side::positive ? stop.clearance : -stop.clearance) - force.law().offset;
        places.push_back(kink - 1e-6);
        places.push_back(kink + 1e-6);
    }
    for (const double q : places) {
        CAPTURE(q);
        const double h = 1e-8, hv = 1e-7;
        const double slope =
            (force.calcForce(q + h, v, t, z.data()) - force.calcForce(q - h, v, t, z.data())) / (2 * h);
        CHECK(force.calcStiffness(q, v, t, z.data()) == Approx(slope).epsilon(1e-5));
        const double rate =
            (force.calcForce(q, v + hv, t, z.data()) - force.calcForce(q, v - hv, t, z.data())) / (2 * hv);
        CHECK(force.calcDamping(q, v, t, z.data()) == Approx(rate).epsilon(1e-5).margin(1e-3));
        const double static_slope = (force.calcStaticForce(q + h) - force.calcStaticForce(q - h)) / (2 * h);
        CHECK(force.calcStaticStiffness(q) == Approx(static_slope).epsilon(1e-5));
    }
}

TEST_CASE("at a kink the derivative is that from outside the stop") {
    AxisLaw law;
    law.stiffness = 1000;
    law.stops = {{Side::positive, 1e-3, 1e6, 2.0}};
    CHECK(AxisForce(law).calcStiffness(1e-3, 0.1, 0, nullptr) == 1000);
    CHECK(AxisForce(law).calcDamping(1e-3, 0.1, 0, nullptr) == 0);
}

TEST_CASE("power in is the change of potential plus what is dissipated, which is never negative") {
    const unsigned seed = GENERATE(range(1U, 60U));
    CAPTURE(seed);
    RandomValues random(seed);
    AxisLaw law = random.law();
    const AxisForce force(law);
    const std::vector<double> z = randomStates(force, random);
    const double q = random.number(-4e-3, 4e-3), v = random.number(-0.5, 0.5), t = random.number(0, 10);
    std::vector<double> zdot(z.size());
    force.calcStateDerivative(q, v, z.data(), zdot.data());
    // d/dt of the potential along the motion, at frozen drift.
    const double h = 1e-8;
    std::vector<double> ahead = z, behind = z;
    for (std::size_t i = 0; i < z.size(); ++i) {
        ahead[i] += h * zdot[i];
        behind[i] -= h * zdot[i];
    }
    const double rate =
        (force.calcPotential(q + h * v, t, ahead.data()) - force.calcPotential(q - h * v, t, behind.data())) / (2 * h);
    const double lost = force.calcDissipatedPower(q, v, t, z.data());
    CHECK(lost >= 0);
    CHECK(force.calcForce(q, v, t, z.data()) * v == Approx(rate + lost).epsilon(1e-5).margin(1e-5));
}

TEST_CASE("a Zener element has the textbook complex stiffness") {
    AxisLaw law;
    law.stiffness = 2e4;
    law.relaxation = Relaxation{0.3, 0.02};
    const AxisForce force(law);
    REQUIRE(force.branches().size() == 1);
    CHECK(force.branches()[0].stiffness == Approx(6000));
    CHECK(force.branches()[0].time_constant == Approx(0.02));
    // Slow: the static stiffness. Sudden: static plus branch.
    double z = 1e-3;
    CHECK(force.calcForce(1e-3, 0, 0, &z) == Approx(20));
    z = 0;
    CHECK(force.calcForce(1e-3, 0, 0, &z) == Approx(26));
}

TEST_CASE("values out of range are named with their key") {
    struct Case {
        const char* key;
        void (*spoil)(AxisLaw&);
    };
    const std::vector<Case> cases = {
        {"stiffness", [](AxisLaw& law) { law.stiffness = -1; }},
        {"damping", [](AxisLaw& law) { law.damping = not_a_number; }},
        {"offset", [](AxisLaw& law) { law.offset = not_a_number; }},
        {"quadratic", [](AxisLaw& law) { law.quadratic = NAN; }},
        {"cubic", [](AxisLaw& law) { law.cubic = INFINITY; }},
        {"loss_factor", [](AxisLaw& law) { law.loss_factor = -0.1; }},
        {"loss_factor", [](AxisLaw& law) { law.loss_factor = largestLossFactor(); }},
        {"drift", [](AxisLaw& law) { law.drift = not_a_number; }},
        {"relaxation.stiffness_ratio",
         [](AxisLaw& law) {
             law.relaxation = Relaxation{-0.1, 0.1};
         }},
        {"relaxation.time_constant",
         [](AxisLaw& law) {
             law.relaxation = Relaxation{0.1, 0};
         }},
        {"friction.force",
         [](AxisLaw& law) {
             law.friction = Friction{-1, 1e-3, {}};
         }},
        {"friction.transition_velocity",
         [](AxisLaw& law) {
             law.friction = Friction{1, 0, {}};
         }},
        {"friction.presliding_stiffness",
         [](AxisLaw& law) {
             law.friction = Friction{1, 1e-3, 0.0};
         }},
        {"hysteresis.force", [](AxisLaw& law) { law.hysteresis->force = -1; }},
        {"hysteresis.yield_displacement", [](AxisLaw& law) { law.hysteresis->yield_displacement = 0; }},
        // Numbers that are accepted one by one, and whose quotient or product none is.
        {"hysteresis.yield_displacement",
         [](AxisLaw& law) {
             law.hysteresis = Hysteresis{1e300, 1e-9};
         }},
        {"friction.transition_velocity",
         [](AxisLaw& law) {
             law.friction = Friction{1, 1e-310, {}};
         }},
        {"relaxation.time_constant",
         [](AxisLaw& law) {
             law.relaxation = Relaxation{0.1, 1e-320};
         }},
        {"relaxation.stiffness_ratio",
         [](AxisLaw& law) {
             law.stiffness = 1e10;
             law.relaxation = Relaxation{1e305, 0.1};
         }},
        {"hysteresis.exponent", [](AxisLaw& law) { law.hysteresis->exponent = 51; }},
        {"hysteresis.exponent", [](AxisLaw& law) { law.hysteresis->exponent = not_a_number; }},
        {"hysteresis.shape", [](AxisLaw& law) { law.hysteresis->shape = 1.01; }},
        {"branches[1].time_constant", [](AxisLaw& law) { law.branches[1].time_constant = 0; }},
        {"branches[0].stiffness", [](AxisLaw& law) { law.branches[0].stiffness = -1; }},
        {"branches",
         [](AxisLaw& law) {
             law.branches.resize(kMostBranches + 1, {1, 1});
         }},
        {"sliders[0].force", [](AxisLaw& law) { law.sliders[0].force = -1; }},
        {"sliders[0].yield_displacement", [](AxisLaw& law) { law.sliders[0].yield_displacement = 0; }},
        {"sliders[0].gap", [](AxisLaw& law) { law.sliders[0].gap = -1e-3; }},
        {"sliders[0].negative_force", [](AxisLaw& law) { law.sliders[0].negative_force = -1; }},
        {"sliders[0].exponent", [](AxisLaw& law) { law.sliders[0].exponent = 0.5; }},
        {"sliders", [](AxisLaw& law) { law.sliders.resize(kMostSliders + 1, law.sliders[0]); }},
        {"stops[1].clearance", [](AxisLaw& law) { law.stops[1].clearance = 0; }},
        {"stops[0].stiffness", [](AxisLaw& law) { law.stops[0].stiffness = not_a_number; }},
        {"stops[1].dissipation", [](AxisLaw& law) { law.stops[1].dissipation = -1; }},
    };
    AxisLaw good;
    good.stiffness = 1;
    good.stops = {{Side::positive, 1e-3, 1e5, 0}, {Side::negative, 1e-3, 1e5, 0}};
    good.hysteresis = Hysteresis{1, 1e-4, 1, 0.5};
    good.branches = {{1, 0.1}, {2, 0.01}};
    good.sliders = {Slider{1, 1e-4, 1e-3, 2.0, 4.0}};
    REQUIRE_FALSE(findProblem(good));
    for (const Case& bad : cases) {
        AxisLaw law = good;
        bad.spoil(law);
        const auto problem = findProblem(law);
        REQUIRE(problem);
        CHECK(problem->key == bad.key);
        CHECK_FALSE(problem->accepted.empty());
    }
}
