// What a proposed run is called, as a sentence and as a command line.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/plan/test_setup.hpp"
#include "tests/seed.hpp"

namespace wems::identify {

TEST_CASE("A planned run in words and as a command") {
    PlannedRun run;
    run.level = {100, 0, 250};
    run.from = 50;
    run.to = 5;
    run.sensors = {true, false};
    CHECK(run.duration() == Approx(60 * std::log2(10.0) / 4));
    CHECK(describe(run) ==
          "sweep down from 50 to 5 Hz at 4 octaves per minute (49.8 s), force x 100 N and z 250 N, recorded as "
          "displacements at 1000 Hz");
    CHECK(formatCommand(run, "mount.toml") ==
          "simulate mount.toml --sweep 50:5 --rate 4 --force x=100,z=250 --sample-rate 1000 -o next.csv");
    run.excitation = Excitation::base;
    run.level = {0, 1.25, 0};
    CHECK(formatCommand(run, "my mount's.toml") ==
          "simulate 'my mount'\\''s.toml' --sweep 50:5 --rate 4 --base-acceleration y=1.25 --sample-rate 1000 -o "
          "next.csv");
}

TEST_CASE("A level rounded down keeps its limit, is near it, and stays where it is when rounded again") {
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> exponent(-8, 8);
    for (int k = 0; k < 1000; ++k) {
        const double value = std::pow(10.0, exponent(random));
        const double level = roundDown(value, 3);
        CAPTURE(value, level);
        CHECK(level <= value * (1 + 1e-12));
        CHECK(level > value * 0.99);
        CHECK(roundDown(level, 3) == level);
    }
    CHECK(roundDown(200, 3) == 200);
    CHECK(roundDown(0.07071, 3) == 0.0707);
}

}  // namespace wems::identify
