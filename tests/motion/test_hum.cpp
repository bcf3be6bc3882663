// Hum of the mains on what drives the device, beside excitations that it must not be taken for.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "identify/motion/hum.hpp"
#include "models/common/units.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

struct Table {
    unsigned seed = test::drawSeed();
    std::mt19937 random{seed};
    double interval = 1e-3, length = 12;

    Recording make(const std::function<double(double)>& acceleration, double noise = 0.02) {
        Recording recording;
        recording.file = "table.csv";
        Channel channel;
        channel.name = "base.az";
        channel.unit = "m/s^2";
        std::normal_distribution<double> normal(0, noise);
        for (int k = 0; k < static_cast<int>(length / interval); ++k) {
            recording.time.push_back(k * interval);
            channel.values.push_back(acceleration(k * interval) + normal(random));
        }
        recording.channels.push_back(channel);
        return recording;
    }

    /// 5 to 200 Hz.
    double sweep(double t) const {
        const double rate = std::log(40.0) / length;
        return 10 * std::sin(kTwoPi * 5 * std::expm1(rate * t) / rate);
    }
};

double calcDeviation(const Recording& recording, const std::function<double(double)>& expected) {
    double sum = 0;
    for (std::size_t k = 0; k < recording.time.size(); ++k)
        sum += std::pow(recording.channels[0].values[k] - expected(recording.time[k]), 2);
    return std::sqrt(sum / static_cast<double>(recording.time.size()));
}

}  // namespace

TEST_CASE("Hum beside a sweep that passes it is taken off the drive") {
    Table table;
    CAPTURE(table.seed);
    // A short recording too: the blocks are then shorter than a second.
    table.length = GENERATE(12.0, 1.5);
    const double mains = GENERATE(50.0, 60.0);
    const double phase = std::uniform_real_distribution<double>(0, kTwoPi)(table.random);
    const double amplitude = 0.3;
    Recording recording =
        table.make([&](double t) { return table.sweep(t) + amplitude * std::sin(kTwoPi * mains * t + phase); });
    std::vector<std::string> notes;
    removeDriveHum(recording, notes);
    REQUIRE(notes.size() == 1);
    CHECK_THAT(notes[0], Catch::StartsWith("base.az: hum of the mains"));
    // Its RMS was 0.21, the noise's is 0.02. Of the short recording's blocks the sweep, 33 times as large, is in a
    // third.
    const double most = table.length > 10 ? 0.05 : 0.1;
    CHECK(calcDeviation(recording, [&](double t) { return table.sweep(t); }) < most);
}

TEST_CASE("What drives the device at the mains' frequency is not taken for hum") {
    Table table;
    CAPTURE(table.seed);
    std::vector<std::string> notes;
    std::function<double(double)> drive;
    SECTION("a sweep that passes it") {
        drive = [&](double t) { return table.sweep(t); };
    }
    SECTION("a dwell") {
        drive = [](double t) { return 5 * std::sin(kTwoPi * 50 * t); };
    }
    SECTION("random excitation") {
        std::normal_distribution<double> normal;
        std::vector<double> a, b;
        for (int i = 0; i < 800; ++i) {
            a.push_back(normal(table.random));
            b.push_back(normal(table.random));
        }
        // 20 to 100 Hz in lines of 0.1 Hz that do not meet the mains'.
        drive = [a, b](double t) {
            double sum = 0;
            for (std::size_t i = 0; i < a.size(); ++i) {
                const double w = kTwoPi * (20.037 + 0.1 * static_cast<double>(i));
                sum += a[i] * std::cos(w * t) + b[i] * std::sin(w * t);
            }
            return 0.1 * sum;
        };
    }
    Recording recording = table.make(drive);
    const std::vector<double> before = recording.channels[0].values;
    removeDriveHum(recording, notes);
    CHECK(notes.empty());
    CHECK(recording.channels[0].values == before);
}

}  // namespace wems::identify
