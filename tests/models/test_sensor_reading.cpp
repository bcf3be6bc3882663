#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "models/common/units.hpp"
#include "models/sensor_reading.hpp"

using namespace wems;

TEST_CASE("corrected channels: gain, delay and rotation undone") {
    Recording truth, measured;
    const double delay = 0.7e-3, gain = 1.3;
    const Eigen::Matrix3d R = Eigen::AngleAxisd(0.2, Eigen::Vector3d(1, 2, 2) / 3).toRotationMatrix();
    const auto motion = [](double t) {
        return Eigen::Vector3d(std::sin(kTwoPi * 5 * t), std::cos(kTwoPi * 7 * t), std::sin(kTwoPi * 3 * t + 1));
    };
    for (const char* axis : {"ax", "ay", "az"})
        for (Recording* recording : {&truth, &measured})
            recording->channels.push_back({std::string("mobile.1.") + axis, "m/s^2", {}, 0});
    for (int k = 0; k < 1000; ++k) {
        const double t = 1e-3 * k;
        const Eigen::Vector3d now = motion(t), seen = gain * (R * motion(t - delay));
        for (std::size_t a = 0; a < 3; ++a) {
            truth.channels[a].values.push_back(now[a]);
            measured.channels[a].values.push_back(seen[a]);
        }
        truth.time.push_back(t);
        measured.time.push_back(t);
    }
    SensorFault fault;
    fault.channel = "mobile.1.a";
    fault.gain = gain;
    fault.delay = delay;
    fault.rotation = 0.2 * Eigen::Vector3d(1, 2, 2) / 3;
    const Recording corrected = correctChannels(measured, {fault});
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t k = 10; k < 990; ++k)  // a cubic through samples 1 ms apart: (2 π 7 · 1e-3)⁴ · 3/128
            REQUIRE(corrected.channels[a].values[k] == Approx(truth.channels[a].values[k]).margin(1e-6));
}

TEST_CASE("A zero is taken away before the gain, of its channel alone") {
    Recording measured;
    measured.time = {0, 1e-3, 2e-3};
    measured.channels = {{"load.fz", "N", {3, 5, 7}, 2}, {"mobile.1.z", "m", {1, 2, 3}, 3}};
    SensorFault fault;
    fault.channel = "load.fz";
    fault.gain = 2;
    fault.zero = 1;
    const Recording corrected = correctChannels(measured, {fault});
    CHECK(corrected.channels[0].values == std::vector<double>{1, 2, 3});
    CHECK(corrected.channels[1].values == measured.channels[1].values);
}

TEST_CASE("A sensor names a channel, one kind of a place, a place or a part") {
    for (const char* group : {"mobile.1.az", "mobile.1.a", "mobile.1", "mobile"})
        CHECK(concernsChannel(group, "mobile.1.az"));
    for (const char* group : {"mobile.1.d", "mobile.1", "mobile"}) CHECK(concernsChannel(group, "mobile.1.z"));
    CHECK(concernsChannel("mobile.1.v", "mobile.1.vz"));
    CHECK(concernsChannel("load", "load.fx"));
    for (const char* group : {"mobile.1.d", "mobile.1.v", "mobile.1.ax", "mobile.10", "fixed", "mobile.10.a"})
        CHECK_FALSE(concernsChannel(group, "mobile.1.az"));
    CHECK_FALSE(concernsChannel("mobile.1", "mobile.10.az"));
}

// Without a delay the reading is a matrix: what it makes of three values is told here axis by axis.
TEST_CASE("Corrected channels: what concerns a channel acts in the order of the list") {
    const Eigen::Vector3d first(0.1, -0.2, 0.3), second(-0.4, 0.1, 0.2), truth(1, 2, -3);
    std::vector<SensorFault> faults(4);
    faults[0] = {"mobile.1.d", 1, 0, first, 0};
    faults[1] = {"mobile.1", 1.2, 0, second, 0};
    faults[2] = {"mobile.1.y", 0.5, 0, Eigen::Vector3d::Zero(), 0.25};
    faults[3] = {"mobile", 1.1, 0, Eigen::Vector3d::Zero(), 0};
    const auto turn = [](const Eigen::Vector3d& v) {
        return Eigen::AngleAxisd(v.norm(), v.normalized()).toRotationMatrix();
    };
    const Eigen::Vector3d displacement = turn(second) * turn(first) * truth, acceleration = turn(second) * truth;
    Recording measured;
    measured.time = {0};
    for (const int axis : {0, 1, 2}) {
        const char letter = "xyz"[axis];
        const double gain = axis == 1 ? 0.5 * 1.32 : 1.32, zero = axis == 1 ? 0.25 : 0;
        measured.channels.push_back({std::string("mobile.1.") + letter, "m", {gain * displacement[axis] + zero}, 0});
        measured.channels.push_back({std::string("mobile.1.a") + letter, "m/s^2", {1.32 * acceleration[axis]}, 0});
        measured.channels.push_back({std::string("fixed.1.") + letter, "m", {truth[axis]}, 0});
    }
    const Recording corrected = correctChannels(measured, faults);
    for (std::size_t c = 0; c < corrected.channels.size(); ++c) {
        INFO(corrected.channels[c].name);
        CHECK(corrected.channels[c].values[0] == Approx(truth[static_cast<Eigen::Index>(c / 3)]).margin(1e-12));
    }
}

TEST_CASE("Channels that say nothing of the truth are named") {
    Recording measured;
    measured.file = "run.csv";
    measured.time = {0, 1e-3};
    for (const char* axis : {"ax", "ay", "az"})
        measured.channels.push_back({std::string("mobile.1.") + axis, "m/s^2", {1, 2}, 0});
    const SensorFault dead{"mobile.1.ay", 0, 0, Eigen::Vector3d::Zero(), 0};
    CHECK_THROWS_WITH(correctChannels(measured, {dead}), Catch::Contains("mobile.1.ay") && Catch::Contains("gain 0"));
    const SensorFault along{"mobile.1.az", 1, 0, Eigen::Vector3d(kTwoPi / 4, 0, 0), 0};
    CHECK_THROWS_WITH(correctChannels(measured, {along}), Catch::Contains("other axes of its triax"));
}
