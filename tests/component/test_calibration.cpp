// What gains leave of a parameter, and two measurements of one force side by side.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/component/calibration.hpp"
#include "identify/component/component_fit.hpp"
#include "tests/component/synthetic_test.hpp"
#include "tests/seed.hpp"

namespace wems::identify {

TEST_CASE("gains leave of a parameter what the powers of its unit say") {
    const GainTolerances gains{0.02, 0.01};
    CHECK(calcGainDeviation("N", gains) == Approx(0.01));
    CHECK(calcGainDeviation("m", gains) == Approx(0.005));
    CHECK(calcGainDeviation("N/m", gains) == Approx(0.5 * std::hypot(0.02, 0.01)));
    CHECK(calcGainDeviation("N s/m", gains) == Approx(0.5 * std::hypot(0.02, 0.01)));
    CHECK(calcGainDeviation("N/m^3", gains) == Approx(0.5 * std::hypot(0.02, 0.03)));
    CHECK(calcGainDeviation("m/s", gains) == Approx(0.005));
    CHECK(calcGainDeviation("s", gains) == 0);
    CHECK(calcGainDeviation("-", gains) == 0);
    const ComponentParameter force{"1.z.friction_force", 100, "N", 97, 103};
    const auto wide = calcIntervalWithGains(force, gains);
    CHECK(wide[1] - 100 == Approx(std::hypot(3, 1.96)));
    CHECK(100 - wide[0] == Approx(wide[1] - 100));
}

TEST_CASE("a stiffness lies in the interval with gains as often as its channels' gains lie in their tolerance") {
    const unsigned seed = test::drawSeed();
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const GainTolerances gains = gainTolerancesOf(ForceSource::recorded);
    CHECK(gains.force == 0.01);
    constexpr int draws = 2000;
    int held = 0;
    for (int k = 0; k < draws; ++k) {
        const double scatter = 1e5 * 2e-3 * normal(random);
        const double reading = (1e5 + scatter) * (1 + 0.5 * gains.force * normal(random)) /
                               (1 + 0.5 * gains.displacement * normal(random));
        const auto wide = calcIntervalWithGains({"1.z.stiffness", reading, "N/m", reading - 392, reading + 392}, gains);
        held += wide[0] <= 1e5 && 1e5 <= wide[1] ? 1 : 0;
    }
    CAPTURE(seed, held);
    CHECK(std::abs(held - 0.95 * draws) < 4 * std::sqrt(0.05 * 0.95 * draws));
}

TEST_CASE("mass times acceleration beside the recorded force: gain, delay, and what is said of them") {
    const unsigned seed = test::drawSeed();
    std::mt19937 random(seed);
    const auto draw = [&](double lower, double upper) {
        return std::uniform_real_distribution<double>(lower, upper)(random);
    };
    int held = 0, held_delays = 0;
    constexpr int draws = 40;
    for (int k = 0; k < draws; ++k) {
        const double gain = draw(0.9, 1.1), delay = draw(-3e-4, 3e-4), offset = draw(-3, 3);
        const Recording recording =
            test::makeSyntheticTest([](double q, double v) { return 2e4 * q + 30 * v; }, {}, seed + k);
        const auto& values = recording.find("force.1.z")->values;
        const Eigen::Index count = static_cast<Eigen::Index>(values.size());
        const Eigen::VectorXd time = Eigen::VectorXd::Map(recording.time.data(), count);
        const Eigen::VectorXd first = Eigen::VectorXd::Map(values.data(), count);
        std::normal_distribution<double> normal(0, 0.5);
        Eigen::VectorXd second(count);
        for (Eigen::Index i = 0; i < count; ++i) {
            // Earlier by the delay, along the straight line between samples.
            const double at =
                std::clamp(static_cast<double>(i) - delay * 2000, 0.0, static_cast<double>(count) - 1.001);
            const auto below = static_cast<Eigen::Index>(at);
            second[i] = gain * (first[below] + (at - static_cast<double>(below)) * (first[below + 1] - first[below])) +
                        offset + normal(random);
        }
        const ForceComparison found = compareForces(time, first, second);
        CAPTURE(seed, k, gain, delay, found.gain, found.delay);
        CHECK(found.gain == Approx(gain).margin(2e-3));
        CHECK(found.delay == Approx(delay).margin(5e-5));
        held += std::abs(found.gain - gain) <= found.gain_half_width ? 1 : 0;
        held_delays += std::abs(found.delay - delay) <= found.delay_half_width ? 1 : 0;
        const std::string said = describe(found, gainTolerancesOf(ForceSource::mass_times_acceleration));
        CHECK((said.find("is off") != std::string::npos) ==
              (std::abs(found.gain - 1) > std::sqrt(2e-4 + 2.5e-5) + found.gain_half_width));
        CHECK((said.find("late") != std::string::npos) == (found.delay >= 0));
    }
    // Of 40 intervals of 95 %: fewer in one of some million runs.
    CHECK(held >= 30);
    CHECK(held_delays >= 30);
}

}  // namespace wems::identify
