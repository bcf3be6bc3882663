#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <string>
#include <utility>

#include "identify/updating/test_problem.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;
using namespace wems::identify::updating;

namespace {

/// A random device, and its motion under a load of two seconds.
std::pair<MountModel, RunMotion> drawMotion(std::mt19937_64& random) {
    MountModel model = identify::testing::makeRandomDevice(random);
    identify::testing::RunPlan plan;
    plan.duration = 2;
    plan.force = {20, 30, 60};
    RunMotion motion = estimateMotion(recordRun(model, plan, random), model);
    return {std::move(model), std::move(motion)};
}

}  // namespace

// What no model says is scaled by the largest relative motion: here by differences of the recorded displacements, whose
// axes the small rotation of the bracket hardly turns. A tenth of the elastomer's force in a dashpot, a fifth in
// friction, a dissipation that doubles the stop's force (identify/problem/unknown.cpp).
TEST_CASE("Reaches are scaled by the largest relative displacement and velocity", "[linearised run]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel model = identify::testing::makeRandomDevice(random);
    identify::testing::RunPlan plan;
    plan.duration = 5;
    plan.force = {20, 30, 60};
    plan.noise = 1e-7;
    const Recording recording = recordRun(model, plan, random);
    double displacement = 0, velocity = 0;
    const double interval = recording.sampleInterval();
    for (const Connection& connection : model.connections)
        for (const char* axis : {".x", ".y", ".z"}) {
            const auto& mobile = recording.find("mobile." + connection.name + axis)->values;
            const auto& fixed = recording.find("fixed." + connection.name + axis)->values;
            for (std::size_t k = 1; k + 1 < mobile.size(); ++k) {
                displacement = std::max(displacement, std::abs(mobile[k] - fixed[k]));
                const double change = mobile[k + 1] - fixed[k + 1] - mobile[k - 1] + fixed[k - 1];
                velocity = std::max(velocity, std::abs(change) / (2 * interval));
            }
        }
    const TestProblem problem({recording}, {}, model);
    const auto reachOf = [&](const std::string& name) {
        const int row = findUnknown(problem.table(), name);
        REQUIRE(row >= 0);
        return problem.table()[row].reach;
    };
    const std::string place = model.connections[0].name + ".z.";
    double stiffness = 0;  // in the mean along that axis
    for (const Connection& connection : model.connections)
        stiffness += connection.axis[2].stiffness / static_cast<double>(model.connections.size());
    CHECK(reachOf(place + "friction_force") == Approx(0.2 * stiffness * displacement).epsilon(0.02));
    CHECK(reachOf(place + "dissipation") == Approx(1 / velocity).epsilon(0.05));
}

// A file of few digits, or a simulation, has less noise than anything that was measured: a hundredth of a micrometre
// stands in its place; what is above that is taken as it is.
TEST_CASE("Noise of a displacement counts from a hundredth of a micrometre on", "[linearised run]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    auto [model, motion] = drawMotion(random);
    for (const auto& [measured, counted] :
         {std::pair(0.0, 1e-8), std::pair(std::nan(""), 1e-8), std::pair(1.2e-8, 1.2e-8), std::pair(3e-6, 3e-6)}) {
        CAPTURE(measured);
        motion.mobile.displacement_noise = motion.fixed.displacement_noise = measured;
        const OpenLoopRun run = makeOpenLoopRun(motion, model, {5, 50}, {});
        CHECK(run.mobile_noise == counted);
        CHECK(run.fixed_noise == counted);
    }
}

// One accelerometer on a table has no redundancy, so that its noise is not known. Dry friction acts on the relative
// velocity without its noise; an unknown noise must not make it zero.
TEST_CASE("A velocity keeps what it has where the noise of an acceleration is not known", "[linearised run]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    auto [model, motion] = drawMotion(random);
    for (PartMotion* part : {&motion.mobile, &motion.fixed}) {
        part->displacement_measured = false;
        part->acceleration_measured = true;
        part->acceleration_noise = std::nan("");
        part->acceleration_covariance.setIdentity();
    }
    const OpenLoopRun run = makeOpenLoopRun(motion, model, {5, 50}, {});
    REQUIRE(run.v.norm() > 0);
    double changed = 0;
    for (Eigen::Index axis = 0; axis < run.v.rows(); ++axis)
        changed += (run.quiet.of(axis).transpose() - run.v.row(axis)).squaredNorm();
    CHECK(std::sqrt(changed) < 0.01 * run.v.norm());
}
