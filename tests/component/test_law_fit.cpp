// Laws with memory from component tests: what was put in comes back, and weights are never negative.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/component/component_diagnosis.hpp"
#include "identify/component/curve_basis.hpp"
#include "models/common/non_negative.hpp"
#include "models/common/units.hpp"
#include "models/sampled_motion.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

/// Two tones with a growing amplitude, 20 s at 200 Hz, and noise on the force.
ComponentData makeTest(const AxisLaw& law, double noise, std::mt19937& generator) {
    ComponentData data;
    data.connection = "1";
    data.axis = 0;
    const Eigen::Index count = 4000;
    for (auto* array : {&data.time, &data.q, &data.velocity}) array->resize(count);
    const auto phase = std::uniform_real_distribution<double>(0, kTwoPi)(generator);
    for (Eigen::Index k = 0; k < count; ++k) {
        const double t = static_cast<double>(k) / 200, w = kTwoPi * 0.4, u = kTwoPi * 1.7;
        data.time[k] = t;
        const double size = 2e-3 * t / 20, growth = 2e-3 / 20;
        const double shape = std::sin(w * t) + 0.5 * std::sin(u * t + phase);
        data.q[k] = size * shape;
        data.velocity[k] = growth * shape + size * (w * std::cos(w * t) + 0.5 * u * std::cos(u * t + phase));
    }
    data.force = calcForceAlong(law, data.time, data.q, data.velocity);
    std::normal_distribution<double> normal(0, noise);
    for (double& f : data.force) f += normal(generator);
    return data;
}

}  // namespace

TEST_CASE("non-negative least squares meets the conditions of its optimum") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 generator(seed);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 30; ++i) {
        Eigen::MatrixXd X(40, 8);
        for (double& x : X.reshaped()) x = normal(generator);
        Eigen::VectorXd y(40);
        for (double& value : y) value = normal(generator);
        const std::vector<bool> bounded{false, true, true, true, true, true, true, true};
        const Eigen::MatrixXd gram = X.transpose() * X;
        const Eigen::VectorXd right = X.transpose() * y;
        const Eigen::VectorXd value = solveNonNegative(gram, right, bounded), gradient = right - gram * value;
        for (Eigen::Index j = 0; j < 8; ++j) {
            CAPTURE(j, value[j], gradient[j]);
            if (j > 0) CHECK(value[j] >= 0);
            if (j > 0 && value[j] == 0)
                CHECK(gradient[j] <= 1e-6);
            else
                CHECK(std::abs(gradient[j]) < 1e-6);
        }
    }
}

TEST_CASE("monotone curves rise over their own cells, pass through rest and add up to a spring") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> place(-3e-3, 2e-3), length(5e-4, 5e-3);
    for (int trial = 0; trial < 20; ++trial) {
        const double lower = place(generator), upper = lower + length(generator);
        const auto basis = makeMonotoneCurves(lower, upper, 9);
        std::vector<CurveRow> sum;
        for (const std::vector<CurveRow>& rows : basis) {
            REQUIRE_FALSE(findProblem(rows));
            const ForceCurve curve(rows);
            CHECK(curve.calcForce(0) == 0);
            double before = curve.calcForce(lower);
            for (double q = lower; q < upper; q += 1e-6) {
                const double force = curve.calcForce(q);
                REQUIRE(force >= before - 1e-15);
                before = force;
            }
            addCurve(rows, 1, sum);
        }
        const ForceCurve spring(sum);
        for (double q = lower; q < upper; q += 0.07e-3) {
            CHECK(spring.calcForce(q) == Approx(q).margin(1e-12));
            CHECK(spring.calcStiffness(q) == Approx(1));
        }
    }
}

TEST_CASE("a slider with gap comes back from a component test, with its law as a model holds it") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 generator(seed);
    AxisLaw law;
    law.stiffness = 2e3;
    law.sliders = {{40, 2e-4, 5e-4, 60.0, {}}};
    const ComponentData data = makeTest(law, 0.2, generator);
    const LawFit fit = fitLaw({data}, {LawTerms::Memory::gap_slider, false, false}, {}, "1.x.");
    REQUIRE(fit.law.sliders.size() == 1);
    CHECK(fit.law.stiffness == Approx(2e3).epsilon(0.03));
    CHECK(fit.law.sliders[0].force == Approx(40).epsilon(0.03));
    CHECK(fit.law.sliders[0].negative_force.value_or(0) == Approx(60).epsilon(0.03));
    CHECK(fit.law.sliders[0].gap == Approx(5e-4).epsilon(0.06));
    CHECK(fit.fraction < 0.03);
    CHECK_FALSE(findProblem(fit.law));
    // The law and its constant force are all that was fitted.
    CHECK(calcLawError(fit.law, fit.force_offset, data) == Approx(fit.fraction).epsilon(1e-6));
}

TEST_CASE("a motion that goes one way is fitted without sliders, which would be a curve") {
    std::mt19937 generator(test::drawSeed());
    AxisLaw law;
    law.stiffness = 2e4;
    ComponentData ramp = makeTest(law, 0.1, generator);
    ramp.q = 1e-3 / 20 * ramp.time;
    ramp.velocity.setConstant(1e-3 / 20);
    ramp.force = calcForceAlong(law, ramp.time, ramp.q, ramp.velocity);
    const LawSelection selection = selectLaw({ramp}, {});
    CHECK(selection.tried.size() > 2);
    for (const LawFit& fit : selection.tried) CHECK(fit.terms.memory == LawTerms::Memory::none);
}

TEST_CASE("the law that a component test shows is chosen, and described on another test") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 generator(seed);
    AxisLaw relaxing;
    relaxing.stiffness = 2e4;
    relaxing.branches = {{1e4, 0.05}, {5e3, 0.6}};
    AxisLaw sliding;
    sliding.stiffness = 2e4;
    sliding.sliders = {{4, 1e-4, 0, {}, {}}, {8, 4e-4, 0, {}, {}}, {6, 1e-3, 0, {}, {}}};
    AxisLaw plain;
    plain.stiffness = 2e4;
    plain.damping = 30;
    // A buffer, soft about rest and towards +: drawn, so that no power of the displacement is it.
    std::uniform_real_distribution<double> share(0.7, 1.3);
    AxisLaw drawn;
    drawn.damping = 30;
    drawn.curve = {{-3e-3, -150 * share(generator), {}}, {-1.5e-3, -45 * share(generator), {}},
                   {-5e-4, -4 * share(generator), {}},   {0, 0, {}},
                   {5e-4, 3 * share(generator), {}},     {1.5e-3, 20 * share(generator), {}},
                   {3e-3, 32 * share(generator), {}}};
    const auto choose = [&](const AxisLaw& law) {
        const ComponentData fitted = makeTest(law, 0.1, generator), judge = makeTest(law, 0.1, generator);
        const LawSelection selection = selectLaw({fitted}, {});
        CHECK(calcLawError(selection.law().law, selection.law().force_offset, judge) < 0.03);
        return selection.law().terms;
    };
    CHECK(choose(relaxing).relaxation);
    const LawTerms buffer = choose(drawn);
    CHECK(buffer.curve);
    CHECK(buffer.memory == LawTerms::Memory::none);
    CHECK(choose(sliding).memory != LawTerms::Memory::none);
    const LawTerms none = choose(plain);
    CHECK(none.memory == LawTerms::Memory::none);
    CHECK_FALSE(none.relaxation);
    CHECK_FALSE(none.curve);
}
