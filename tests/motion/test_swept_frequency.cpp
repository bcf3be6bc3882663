#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/motion/swept_frequency.hpp"
#include "models/excitation.hpp"
#include "tests/motion/analytic_motion.hpp"

namespace wems::identify {
namespace {

void addLoad(Recording& recording, const Signal& signal, double noise, std::mt19937& random) {
    std::normal_distribution<double> normal(0, noise);
    for (const char* name : {"load.fx", "load.fz"}) {
        Channel channel;
        channel.name = name;
        const double gain = channel.name == "load.fz" ? 200 : -60;
        for (const double t : recording.time) channel.values.push_back(gain * (signal.value(t) + normal(random)));
        recording.channels.push_back(channel);
    }
}

TEST_CASE("Swept frequency follows sweeps up and down, with noise") {
    const unsigned seed = std::random_device{}();
    CAPTURE(seed);
    std::mt19937 random(seed);
    const auto [from, to, noise] =
        GENERATE(table<double, double, double>({{5, 50, 0}, {5, 50, 0.05}, {50, 5, 0.05}, {1, 12, 0.02}}));
    CAPTURE(from, to, noise);
    const auto signal = makeLogarithmicSweep(from, to, 8, {0.5, 0.5});
    Recording recording = test::makeEmptyRecording(1500, signal->duration());
    addLoad(recording, *signal, noise, random);
    const SweptFrequency swept = findSweptFrequency(recording);
    REQUIRE(swept.is_sine);
    CHECK(swept.source == "load");
    CHECK(swept.lowest == Approx(std::min(from, to)).epsilon(0.1));
    CHECK(swept.highest == Approx(std::max(from, to)).epsilon(0.3));
    for (std::size_t k = 0; k < recording.time.size(); ++k) {
        const double t = recording.time[k];
        if (t < 1.5 || t > signal->duration() - 1.5) continue;
        REQUIRE(swept.hertz[static_cast<Eigen::Index>(k)] == Approx(signal->frequency(t)).epsilon(0.02));
    }
}

TEST_CASE("A random drive has a band but no swept frequency") {
    std::mt19937 random(1);
    const auto signal = makeBandLimitedRandom(8, 60, 20, 7);
    Recording recording = test::makeEmptyRecording(1000, 20);
    addLoad(recording, *signal, 0.01, random);
    const SweptFrequency swept = findSweptFrequency(recording);
    CHECK_FALSE(swept.is_sine);
    CHECK(std::isnan(swept.hertz[100]));
    CHECK(swept.lowest == Approx(8).epsilon(0.15));
    CHECK(swept.highest == Approx(60).epsilon(0.15));
}

TEST_CASE("Without load the motion itself tells the frequency") {
    std::mt19937 random(3);
    Recording recording = test::makeEmptyRecording(1000, 5);
    Channel channel;
    channel.name = "fixed.1.z";
    std::normal_distribution<double> normal(0, 1e-6);
    for (const double t : recording.time)
        channel.values.push_back(1e-4 * std::sin(2 * 3.14159265358979 * 12 * t) + normal(random));
    recording.channels.push_back(channel);
    const SweptFrequency swept = findSweptFrequency(recording);
    CHECK(swept.source == "fixed part");
    CHECK(swept.hertz[2500] == Approx(12).epsilon(0.005));
}

}  // namespace
}  // namespace wems::identify
