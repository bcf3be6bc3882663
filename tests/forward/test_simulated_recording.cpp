#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/forward/simulated_recording.hpp"
#include "identify/motion/motion.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

identify::testing::RunPlan makePlan(double duration, double level, double noise) {
    identify::testing::RunPlan plan;
    plan.duration = duration;
    plan.force = level * Eigen::Vector3d(20, 40, 250);
    plan.noise = noise;
    return plan;
}

}  // namespace

TEST_CASE("A simulated recording is the model's motion, with the recording's noise, of either sign", "[diagnose]") {
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const auto model = identify::testing::makeRandomDevice(random);
    constexpr double kNoise = 3e-6;
    // Short of the stops: a contact would amplify what interpolation of the recorded load leaves.
    const auto motion = estimateMotion(recordRun(model, makePlan(2, 0.04, kNoise), random), model);
    const auto exact = recordRun(model, makePlan(2, 0.04, 0), random);
    const auto plus = simulateRecording(motion, model, {1, 0}), minus = simulateRecording(motion, model, {-1, 0});
    double largest = 0, mean_error = 0, square = 0;
    std::size_t count = 0;
    for (const auto& channel : exact.channels) {
        CAPTURE(channel.name);
        const auto *one = plus.find(channel.name), *other = minus.find(channel.name);
        REQUIRE(one != nullptr);
        REQUIRE(other != nullptr);
        const bool driving = channel.name.rfind("load", 0) == 0;
        for (std::size_t k = 0; k < channel.values.size(); ++k) {
            const double mean = 0.5 * (one->values[k] + other->values[k]);
            if (driving) {
                REQUIRE(one->values[k] == Approx(channel.values[k]).margin(1e-9));
                continue;
            }
            largest = std::max(largest, std::abs(channel.values[k]));
            mean_error = std::max(mean_error, std::abs(mean - channel.values[k]));
            square += std::pow(0.5 * (one->values[k] - other->values[k]), 2);
            ++count;
        }
    }
    CAPTURE(mean_error, largest);
    CHECK(mean_error < 1e-3 * largest);
    // Two estimates of the noise, each from tens of thousands of values.
    CHECK(std::sqrt(square / static_cast<double>(count)) == Approx(kNoise).epsilon(0.03));
}
