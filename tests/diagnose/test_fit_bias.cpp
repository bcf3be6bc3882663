#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/exact/expectation.hpp"
#include "identify/exact/open_loop_problem.hpp"
#include "identify/exact/trial_fits.hpp"
#include "identify/motion/motion.hpp"
#include "models/parameter_access.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

constexpr double kScatter = 1e-3;

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

/// At 500 Hz a contact lasts a few samples, so that δ' is smoothed: χ comes out some 10 % low. How much must be known
/// without knowing the truth.
TEST_CASE("The bias of a stop's dissipation is found from the recording alone", "[diagnose]") {
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    constexpr int kTrials = 4;
    double before = 0, after = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
        auto truth = identify::testing::makeRandomDevice(random);
        const double dissipation = std::uniform_real_distribution<double>(1.5, 2.5)(random);
        std::vector<std::string> names;
        for (const auto& connection : truth.connections) names.push_back(connection.name + ".z.dissipation");
        const std::vector<Knob> knobs{makeSharedKnob(names)};
        knobs[0].set(truth, dissipation);
        auto plan = makePlan(8, 2, 1e-6);
        plan.rate = 500;
        const auto motion = estimateMotion(recordRun(truth, plan, random), truth);
        const OpenLoopProblem problem({makeOpenLoopRun(motion, truth, {5, 50}, {})}, truth, kScatter);
        const auto fit = fitParameters(problem, truth, knobs);
        const auto bias = calcFitBias({motion}, truth, fit.model, knobs);
        const double error = fit.values[0] / dissipation - 1;
        before += std::pow(error, 2) / kTrials;
        after += std::pow(error - bias[0] / dissipation, 2) / kTrials;
    }
    CAPTURE(std::sqrt(before), std::sqrt(after));
    CHECK(after < 0.5 * before);
}
