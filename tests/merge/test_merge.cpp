// Signals known in closed form, sampled by two clocks.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/merge/merge.hpp"
#include "models/common/error.hpp"
#include "models/common/units.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

/// A sweep from 5 to 50 Hz in 20 s, from 0 s on.
double sweepAt(double t) {
    const double rate = std::log(10.0) / 20;
    return t < 0 || t > 20 ? 0 : std::sin(kTwoPi * 5 * (std::exp(rate * t) - 1) / rate) * std::min(1.0, t);
}

Recording record(const std::string& file, double from, double to, double rate, double clock, const std::string& own,
                 double gain, double noise, std::mt19937& random) {
    std::normal_distribution<double> error(0, noise);
    Recording run;
    run.file = file;
    Channel common{"load.fz", "N", {}, 2}, channel{own, "", {}, 3};
    const auto count = static_cast<int>((to - from) * rate);
    for (int k = 0; k < count; ++k) {
        const double t = from + k / rate;
        run.time.push_back(t + clock);
        common.values.push_back(200 * gain * (sweepAt(t) + error(random)));
        channel.values.push_back(1e-3 * sweepAt(t - 0.01));
    }
    run.channels = {common, channel};
    return run;
}

}  // namespace

TEST_CASE("What is in the band passes, what is above half of the new rate is gone") {
    const double frequency = GENERATE(3.0, 20.0, 40.0, 55.0, 90.0, 180.0, 400.0);
    CAPTURE(frequency);
    UniformSignal signal{0.25, 1e-3, {}};
    for (int k = 0; k < 5000; ++k) signal.values.push_back(std::sin(kTwoPi * frequency * (0.25 + 1e-3 * k) + 0.3));
    const double interval = 0.0101;  // 99 Hz, half of it 49.5
    const UniformSignal result = resample(signal, 1.0003, interval, 300);
    double error = 0, level = 0;
    for (std::size_t k = 0; k < result.values.size(); ++k) {
        const double t = 1.0003 + interval * static_cast<double>(k);
        error = std::max(error, std::abs(result.values[k] - std::sin(kTwoPi * frequency * t + 0.3)));
        level = std::max(level, std::abs(result.values[k]));
    }
    if (frequency < 0.42 * 99) {
        CHECK(error < 1e-3);
    } else {
        CHECK(level < 2e-4);
    }
}

// Four values on each sample have weights that come again; one by one, at another interval, none has.
TEST_CASE("A signal on a finer grid has the values of each time by itself, to its ends") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    UniformSignal signal{0.25, 1e-3, {}};
    for (int k = 0; k < 200; ++k) signal.values.push_back(normal(random));
    const double start = 0.25 + 0.3e-3;
    const UniformSignal fine = resample(signal, start, 0.25e-3, 790);
    for (std::size_t k = 0; k < fine.values.size(); ++k) {
        const double t = start + fine.interval * static_cast<double>(k);
        CAPTURE(k);
        CHECK(fine.values[k] == Approx(resample(signal, t, 0.9e-3, 1).values[0]).margin(1e-9));
    }
}

TEST_CASE("Two systems of different rate and clock come together on the first one's") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    const double clock = std::uniform_real_distribution<double>(-50, 50)(random);
    const Recording a = record("a.csv", -2, 21, 1000, 0, "mobile.1.z", 1, 0.003, random);
    const Recording b = record("b.mat", -1, 24, 317, clock, "mobile.1.az", 1.1, 0.003, random);
    const Recording merged = merge({a, b}, {"load.fz", 0}).recording;
    CHECK(1 / merged.sampleInterval() == Approx(317));
    CHECK(merged.time.front() == Approx(-1).margin(2e-4));
    CHECK(merged.time.back() == Approx(21).margin(0.01));
    REQUIRE(merged.channels.size() == 3);
    for (const char* name : {"mobile.1.z", "mobile.1.az"}) {
        const Channel* channel = merged.find(name);
        REQUIRE(channel != nullptr);
        double error = 0;
        for (std::size_t k = 0; k < merged.time.size(); ++k) {
            const double t = merged.time[k];
            if (t > 0.5 && t < 19.5) error = std::max(error, std::abs(channel->values[k] - 1e-3 * sweepAt(t - 0.01)));
        }
        CAPTURE(name);
        CHECK(error < 3e-6);  // 10 µs at 50 Hz
    }
    const auto has = [&](const std::string& text) {
        return std::any_of(merged.warnings.begin(), merged.warnings.end(),
                           [&](const std::string& note) { return note.find(text) != std::string::npos; });
    };
    CHECK(has("b.mat: shifted by"));
    CHECK(has("is 1.1 times the first one's"));
    CHECK(!has("clocks do not run alike"));
}

TEST_CASE("Clocks that run apart are noticed") {
    std::mt19937 random(4);
    const Recording a = record("a.csv", -2, 21, 1000, 0, "mobile.1.z", 1, 0.001, random);
    Recording b = record("b.csv", -1, 24, 500, 3, "mobile.1.az", 1, 0.001, random);
    for (double& t : b.time) t *= 1.0002;
    const Recording merged = merge({a, b}, {"load.fz", 0}).recording;
    const bool noticed = std::any_of(merged.warnings.begin(), merged.warnings.end(), [](const std::string& note) {
        return note.find("clocks do not run alike") != std::string::npos;
    });
    CHECK(noticed);
}

TEST_CASE("What cannot be merged is refused") {
    std::mt19937 random(5);
    const Recording a = record("a.csv", -2, 21, 500, 0, "mobile.1.z", 1, 0.001, random);
    Recording b = record("b.csv", -1, 24, 500, 100, "mobile.1.az", 1, 0.001, random);
    CHECK_THROWS_WITH(merge({a}, {}), Catch::Contains("cannot be merged"));
    CHECK_THROWS_WITH(merge({a, b}, {"base.az", 0}), Catch::Contains("base.az: the common channel is not in this"));
    Recording many = a;
    for (int i = 2; i < 40; ++i)
        many.channels.push_back({"mobile." + std::to_string(i) + ".z", "m", a.channels[0].values});
    CHECK_THROWS_WITH(merge({many, b}, {"base.az", 0}),
                      Catch::Contains("mobile.5.z and 34 more, which `identify inspect` lists"));
    CHECK_THROWS_WITH(merge({a, b}, {}), Catch::Contains("have no time in common"));
    CHECK_THROWS_WITH(merge({a, a}, {"load.fz", 0}), Catch::Contains("mobile.1.z: is in another"));
    std::normal_distribution<double> normal;
    for (double& value : b.channels[0].values) value = normal(random);
    CHECK_THROWS_WITH(merge({a, b}, {"load.fz", 0}), Catch::Contains("does not match that of a.csv"));
}

}  // namespace wems::identify
