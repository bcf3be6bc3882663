#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "identify/component/component_data.hpp"
#include "models/common/units.hpp"

namespace wems::identify {
namespace {

Eigen::VectorXd makeSine(double amplitude, int cycles, int per_cycle) {
    Eigen::VectorXd q(cycles * per_cycle);
    for (Eigen::Index i = 0; i < q.size(); ++i)
        q[i] = amplitude * std::sin(kTwoPi * static_cast<double>(i) / per_cycle);
    return q;
}

}  // namespace

TEST_CASE("Reversals of a sine are its extremes, whatever small ripple rides on it") {
    Eigen::VectorXd q = makeSine(0.01, 4, 1000);
    for (Eigen::Index i = 0; i < q.size(); ++i) q[i] += 1e-4 * std::sin(0.9 * static_cast<double>(i));
    const auto reversals = findReversals(q, 0.05);
    REQUIRE(reversals.size() == 8);
    for (std::size_t k = 0; k < 8; ++k) {
        CHECK(reversals[k].direction == (k % 2 == 0 ? -1 : 1));
        CHECK(std::abs(static_cast<double>(reversals[k].index) - (250.0 + 500.0 * static_cast<double>(k))) < 50);
    }
    CHECK(findReversals(Eigen::VectorXd::Constant(10, 1.0), 0.05).empty());
}

TEST_CASE("Levels and gap of a slider behind a play, both directions different") {
    // A play of width g: the slider stands still while the input crosses the gap, then slides at its level.
    const double gap = 2.4e-3, plus = 14000, minus = 18000;
    const Eigen::VectorXd q = makeSine(0.02, 5, 4000);
    Eigen::VectorXd f(q.size());
    double slider = 0;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
        const double before = slider;
        slider = std::clamp(slider, q[i] - gap / 2, q[i] + gap / 2);
        f[i] = slider > before ? plus : (slider < before ? -minus : 0.0);
    }
    const auto s = summariseFriction(q, f);
    CHECK(s.positive_level.value == Approx(plus));
    CHECK(s.negative_level.value == Approx(-minus));
    // The sampling resolves the travel near a reversal to better than 1 %.
    CHECK(s.gap.value == Approx(gap).epsilon(0.01));
    CHECK(s.loop_fill == Approx(1 - gap / 0.04).epsilon(0.01));
    CHECK(s.flatness < 1e-9);
}

}  // namespace wems::identify
