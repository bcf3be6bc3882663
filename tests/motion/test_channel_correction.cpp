#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "identify/motion/channel_correction.hpp"
#include "models/common/units.hpp"

using namespace wems;
using namespace wems::identify;

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
