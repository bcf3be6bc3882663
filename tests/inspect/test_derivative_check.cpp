// Accelerations against the displacements beside them, of an analytic motion.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/inspect/quality.hpp"
#include "models/common/units.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

/// Three sines of 7, 15 and 31 Hz whose amplitudes vary slowly, with noise of 1 % on both channels.
Recording makeRecording(double factor, double time_factor) {
    const unsigned seed = 20261122;
    INFO("seed " << seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, 1);
    Recording recording;
    recording.channels = {{"mobile.1.z", "m", {}, 2}, {"mobile.1.az", "m/s^2", {}, 3}, {"fixed.1.az", "m/s^2", {}, 4}};
    for (int k = 0; k < 6000; ++k) {
        const double t = 1e-3 * k;
        double q = 0, a = 0;
        for (const double f : {7.0, 15.0, 31.0}) {
            // Products of sines as sums of lines, of which the second derivative is exact.
            for (const double shift : {-0.4, 0.4}) {
                const double omega = kTwoPi * (f + shift);
                q += 1e-3 * std::sin(omega * t);
                a -= 1e-3 * omega * omega * std::sin(omega * t);
            }
        }
        recording.time.push_back(time_factor * t);
        recording.channels[0].values.push_back(q + 1e-5 * normal(random));
        recording.channels[1].values.push_back(factor * (a + 0.3 * normal(random)));
        recording.channels[2].values.push_back(normal(random));
    }
    return recording;
}

}  // namespace

TEST_CASE("Accelerations that are the second derivatives raise no contradiction, nor do small errors of gain") {
    for (const double factor : {1.0, 0.9, 1.2}) CHECK(findContradictions(makeRecording(factor, 1)).empty());
}

TEST_CASE("Wrong units and signs are told from the ratio") {
    const auto check = [](double factor, double time_factor, const char* mistake) {
        const auto found = findContradictions(makeRecording(factor, time_factor));
        REQUIRE(found.size() == 1);
        CHECK_THAT(found.front(), Catch::StartsWith("contradiction: mobile.1.az is") && Catch::Contains(mistake));
    };
    check(1 / 9.80665, 1,
          "about 0.1 times the second derivative of the displacement beside (as from accelerations in g");
    check(9.80665, 1, "accelerations in m/s^2 labelled g");
    check(-1, 1, "wrong sign");
    check(1, 1e3, "a time in ms labelled s");
    check(1e-3, 1, "displacements in mm labelled m");
    check(2.5, 1, "times the second derivative of the displacement beside");
}

TEST_CASE("Too short, still or unrelated channels tell nothing") {
    Recording recording = makeRecording(0.1, 1);
    recording.time.resize(20);
    for (Channel& channel : recording.channels) channel.values.resize(20);
    CHECK(findContradictions(recording).empty());
    recording = makeRecording(0.1, 1);
    recording.channels[1].values = recording.channels[2].values;  // noise
    CHECK(findContradictions(recording).empty());
    for (double& value : recording.channels[0].values) value = 0;
    CHECK(findContradictions(recording).empty());
}
