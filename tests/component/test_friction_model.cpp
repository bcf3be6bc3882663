#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/component/friction_model.hpp"

namespace wems::identify {
namespace {

ComponentData makeMotion(double amplitude, unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> uniform(0.5, 1.0);
    ComponentData data;
    const Eigen::Index n = 8000;
    data.q.resize(n);
    const double second = uniform(generator);
    for (Eigen::Index i = 0; i < n; ++i) {
        const double t = 1e-3 * static_cast<double>(i);
        data.q[i] = amplitude * (std::sin(6.28 * t) + 0.3 * std::sin(6.28 * (1 + second) * t));
    }
    data.velocity = Eigen::VectorXd::Zero(n);
    data.force = Eigen::VectorXd::Zero(n);
    return data;
}

}  // namespace

TEST_CASE("A friction element's loop has the area of its levels less gap and presliding") {
    // One closed cycle of amplitude A from one limit to the other dissipates, per half stroke of 2A: the level times
    // the travel that is left after gap and unloading, plus the elastic triangle that is stored and given back.
    const FrictionGapLaw law{14000, 18000, 2.5e-3, 4e-3};
    const double A = 0.02;
    const Eigen::Index per_cycle = 20000;
    Eigen::VectorXd q(2 * per_cycle + 1);
    for (Eigen::Index i = 0; i < q.size(); ++i)
        q[i] = A * std::sin(2 * 3.14159265358979 * static_cast<double>(i) / static_cast<double>(per_cycle));
    const Eigen::VectorXd f = simulateFriction(law, q);
    CHECK(f.maxCoeff() == Approx(14000));
    CHECK(f.minCoeff() == Approx(-18000));
    double energy = 0;  // second cycle, from the same state to the same state
    for (Eigen::Index i = per_cycle + 1; i < q.size(); ++i) energy += 0.5 * (f[i] + f[i - 1]) * (q[i] - q[i - 1]);
    const double sliding = 2 * A - law.gap - 2 * law.presliding;
    CHECK(energy == Approx((14000 + 18000) * sliding).epsilon(1e-3));
}

TEST_CASE("Levels, presliding and gap are recovered within their intervals; without gap the error stays") {
    const auto seed = GENERATE(1U, 2U, 3U, 4U, 5U);
    CAPTURE(seed);
    const FrictionGapLaw truth{12e3, 17e3, 2e-3, 3e-3};
    std::mt19937 generator(seed + 100);
    std::normal_distribution<double> normal;
    std::vector<ComponentData> tests{makeMotion(0.012, seed), makeMotion(0.02, seed + 50)};
    for (auto& test : tests) {
        test.force = simulateFriction(truth, test.q);
        double noise = 0;
        for (auto& f : test.force) {
            noise = 0.95 * noise + 100 * normal(generator);
            f += noise;
        }
    }
    const auto fit = fitFrictionGap(tests, true);
    const double expected[] = {12e3, -17e3, 2e-3, 3e-3};
    REQUIRE(fit.parameters.size() == 4);
    for (std::size_t k = 0; k < 4; ++k) {
        const auto& p = fit.parameters[k];
        CAPTURE(p.name, p.value, p.lower, p.upper);
        // Twice the half width: beyond chance.
        CHECK(std::abs(p.value - expected[k]) <= p.upper - p.lower);
        CHECK(p.upper - p.lower < 0.1 * std::abs(expected[k]));
    }
    CHECK(fitFrictionGap(tests, false).relative_error > 3 * fit.relative_error);
    CHECK(calcRelativeError(fit.law, tests[0]) < 0.05);
}

}  // namespace wems::identify
