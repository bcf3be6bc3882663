// Sweeps by a test specification: levels, crossovers, notches, units, and what is refused.
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>

#include "models/common/error.hpp"
#include "models/common/units.hpp"
#include "models/sweep_profile.hpp"

using namespace wems;

namespace {

constexpr double kGravity = 9.80665;

}  // namespace

TEST_CASE("a profile: displacement, velocity and acceleration, the crossover where they meet") {
    const SweepProfile profile = parseSweepProfile(
        "from [Hz],to [Hz],level\n# qualification\n5,100,10mm\n5;100;0.6m/s\n5 100 3g\n", "profile.csv");
    CHECK(profile.lowest() == 5);
    CHECK(profile.highest() == 100);
    CHECK_FALSE(profile.isForce());
    // 10 mm w² below w = v/x = 60 rad/s, 0.6 m/s w below w = a/v, 3 g above.
    const double first = 60 / kTwoPi, second = 3 * kGravity / 0.6 / kTwoPi;
    const bool velocity = second > first;  // 7.8 Hz: the velocity never holds here
    CHECK_FALSE(velocity);
    const double crossover = std::sqrt(3 * kGravity / 0.01) / kTwoPi;
    const auto changes = profile.findChanges();
    REQUIRE(changes.size() == 1);
    CHECK(changes[0] == Approx(crossover).epsilon(1e-9));
    CHECK(profile.calcLevel(6) == Approx(0.01 * std::pow(kTwoPi * 6, 2)));
    CHECK(profile.calcLevel(50) == Approx(3 * kGravity));

    const SweepProfile with_velocity = parseSweepProfile("5,100,10mm\n5,100,0.4m/s\n5,100,3g\n", "profile.csv");
    REQUIRE(with_velocity.findChanges().size() == 2);
    CHECK(with_velocity.findChanges()[0] == Approx(0.4 / 0.01 / kTwoPi).epsilon(1e-9));
    CHECK(with_velocity.findChanges()[1] == Approx(3 * kGravity / 0.4 / kTwoPi).epsilon(1e-9));
    CHECK(with_velocity.calcLevel(9) == Approx(0.4 * kTwoPi * 9));
}

TEST_CASE("a notch holds between its ends, passes over within a 24th of an octave, slopes are straight in log-log") {
    const SweepProfile profile = parseSweepProfile("5,100,2g\n28,34,0.5g\n60,100,2g,1g\n", "profile.csv");
    const double half = std::exp2(1.0 / 48);
    for (const double f : {5.0, 27.0, 35.0, 58.0}) CHECK(profile.calcLevel(f) == Approx(2 * kGravity));
    for (const double f : {28 * half * 1.001, 31.0, 34 / half / 1.001})
        CHECK(profile.calcLevel(f) == Approx(0.5 * kGravity));
    CHECK(profile.calcLevel(28) == Approx(kGravity));  // the middle of the passage, in the logarithm
    CHECK(profile.calcLevel(34) == Approx(kGravity));
    CHECK(profile.calcLevel(std::sqrt(6000.0)) == Approx(std::sqrt(2.0) * kGravity));
    CHECK(profile.calcLevel(100) == Approx(kGravity));
    // Neither the level nor its slope jumps: a cubic over the passage bends by at most 6 ln 4 over its length squared.
    const double step = 1e-4, bend = 6 * std::log(4.0) / std::pow(2 * std::log(half), 2);
    double last = std::log(profile.calcLevel(5)), slope = 0;
    for (double x = std::log(5.0) + step; x < std::log(100.0); x += step) {
        const double level = std::log(profile.calcLevel(std::exp(x)));
        CHECK(std::abs((level - last) / step - slope) < 1.1 * bend * step);
        slope = (level - last) / step;
        last = level;
    }
}

TEST_CASE("the acceleration of a profiled sweep is that of a table that goes where the profile says") {
    const SweepProfile profile = parseSweepProfile("5,50,2mm\n5,50,1g\n20,26,0.2g\n", "profile.csv");
    const std::shared_ptr<const Signal> sweep = makeLogarithmicSweep(5, 50, 20);
    const auto signal = makeProfiledSweep(sweep, profile, {0.2, 0.3});
    const double T = signal->duration();
    CHECK(T == sweep->duration());
    CHECK(signal->highestFrequency() == Approx(50));
    // Integrated twice by Simpson's rule from where it says that it starts.
    const auto start = signal->integralsAtStart();
    REQUIRE(start);
    double v = start->first, x = start->second, worst = 0;
    const double h = 1e-4;
    for (double t = 0; t < T - h; t += h) {
        const double omega = kTwoPi * sweep->frequency(t);
        double weight = 1;
        if (t < 0.2) weight = 0.5 * (1 - std::cos(kPi * t / 0.2));
        if (T - t < 0.3) weight = 0.5 * (1 - std::cos(kPi * (T - t) / 0.3));
        const double level = weight * profile.calcLevel(sweep->frequency(t));
        worst = std::max(worst, std::abs(x - level / (omega * omega) * std::sin(sweep->phase(t))));
        const double a = signal->value(t), b = signal->value(t + h / 2), c = signal->value(t + h);
        x += h * v + h * h / 6 * (a + 2 * b);
        v += h / 6 * (a + 4 * b + c);
    }
    CHECK(worst < 4e-6);  // of 2 mm, after ten seconds
    CHECK(signal->value(-1) == 0);
    CHECK(signal->value(T + 1) == 0);
    const auto unfaded = makeProfiledSweep(sweep, profile);
    CHECK(unfaded->value(T / 2) == signal->value(T / 2));
    for (const double t : {0.0, 1e-5, T - 1e-5, T}) CHECK(std::isfinite(unfaded->value(t)));
    CHECK_THROWS_AS(makeProfiledSweep(sweep, profile, {6, 6}), InputError);
}

TEST_CASE("a profiled force is the sweep times its level") {
    const SweepProfile profile = parseSweepProfile("5,50,0.2kN\n", "profile.csv");
    const std::shared_ptr<const Signal> sweep = makeLogarithmicSweep(5, 50, 20);
    const auto signal = makeProfiledSweep(sweep, profile);
    for (double t = 0.01; t < signal->duration(); t += 0.37)
        CHECK(signal->value(t) == Approx(200 * std::sin(sweep->phase(t))).margin(1e-9));
    CHECK_FALSE(signal->integralsAtStart());
}

TEST_CASE("a profile that makes no sense is refused with its line") {
    const auto [text, words] = GENERATE(table<const char*, const char*>({
        {"5,50\n", "profile.csv:1"},
        {"5,50,2\n", "no level"},
        {"# c\n5,50,2 s\n", "profile.csv:2"},
        {"5,50,-2mm\n", "no level"},
        {"5,x,2mm\n", "no frequency"},
        {"50,5,2mm\n", "not above"},
        {"5,20,2mm\n30,50,1g\n", "gap from 20 to 30"},
        {"5,50,2mm\n5,50,100N\n", "force"},
        {"5,50,2mm,1g\n", "two quantities"},
        {"# nothing\n", "no row"},
    }));
    CHECK_THROWS_WITH(parseSweepProfile(text, "profile.csv"), Catch::Contains(words) && Catch::Contains("profile.csv"));
}
