// A stop believed beyond what the motion reaches, where contact has no slope.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/catalogue/axis_reach.hpp"
#include "identify/updating/settling.hpp"
#include "identify/updating/untouched_stops.hpp"
#include "models/parameter_access.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/seed.hpp"

namespace wems::identify::updating {
namespace {

constexpr const char* kName = "1.z.+.clearance";

identify::testing::RunPlan makePlan() {
    identify::testing::RunPlan plan;
    plan.duration = 4;
    plan.force = Eigen::Vector3d(20, 40, 250);
    return plan;
}

/// A random device with one stop, out of reach.
MountModel makeOneStop(std::mt19937_64& random) {
    MountModel model = identify::testing::makeRandomDevice(random);
    for (std::size_t i = 0; i < model.connections.size(); ++i)
        for (std::size_t a = 0; a < 3; ++a) {
            std::vector<Stop>& stops = model.connections[i].axis[a].stops;
            const Stop kept = stops.empty() ? Stop{} : stops.front();
            stops.clear();
            if (i == 0 && a == 2) stops = {kept};
        }
    setParameter(model, kName, 1);
    return model;
}

/// m, towards the stop
double findReach(const MountModel& model, std::mt19937_64& random) {
    const TestProblem problem({recordRun(model, makePlan(), random)}, {}, model);
    AxisReach reach(model);
    reach.widen(problem.calcExactRun(0, problem.believedPoint()).motion, model);
    return reach.positive[2];
}

}  // namespace

TEST_CASE("A stop that is believed out of reach is found where it is touched", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    MountModel truth = makeOneStop(random);
    REQUIRE(truth.connections[0].axis[2].stops.front().side == Side::positive);
    // Believed beyond all motion, though within its tolerance of 5 %.
    const double reach = findReach(truth, random);
    const double clearance = std::uniform_real_distribution<double>(0.975, 0.995)(random) * reach;
    setParameter(truth, kName, clearance);
    MountModel believed = truth;
    setParameter(believed, kName, 1.03 * reach);
    const TestProblem problem({recordRun(truth, makePlan(), random)}, {}, believed);
    const int row = findUnknown(problem.table(), kName);
    CAPTURE(reach, clearance);

    const auto untouched = findUntouchedStops(problem, problem.believedPoint());
    REQUIRE(untouched.size() == 1);
    CHECK(untouched.front().row == row);
    CHECK(untouched.front().reached > clearance);
    CHECK(untouched.front().reached < 1.02 * reach);
    CHECK(untouched.front().nearest == Approx(0.95 * 1.03 * reach));

    const Settler settler(problem);
    SetState state;
    state.point = problem.believedPoint();
    state.view = problem.view(state.point, state.set);
    settler.settle(state, 12, true);
    const double found = state.point.values[row];
    const Eigen::MatrixXd covariance =
        makeEvidence(problem, state.view, state.set, state.scales, true).calcPosterior(state.set).covariance;
    CAPTURE(found, std::sqrt(covariance(row, row)));
    CHECK(std::abs(found - clearance) < 4 * std::sqrt(covariance(row, row)));
    CHECK(std::abs(found - clearance) < 0.2 * (1.03 * reach - clearance));
}

// Nor is one looked for that the motion would reach only beyond its tolerance.
TEST_CASE("A stop that stays out of reach is left where it is believed", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    MountModel truth = makeOneStop(random);
    const double reach = findReach(truth, random);
    setParameter(truth, kName, 1.06 * reach);
    const TestProblem far({recordRun(truth, makePlan(), random)}, {}, truth);
    CHECK(findUntouchedStops(far, far.believedPoint()).empty());
    setParameter(truth, kName, 1.02 * reach);
    const TestProblem near({recordRun(truth, makePlan(), random)}, {}, truth);
    REQUIRE(findUntouchedStops(near, near.believedPoint()).size() == 1);
    const Settler settler(near);
    SetState state;
    state.point = near.believedPoint();
    state.view = near.view(state.point, state.set);
    settler.settle(state, 12, true);
    // Or as near as noise makes it seem to be touched.
    const double found = state.point.values[findUnknown(near.table(), kName)];
    CAPTURE(reach, found);
    CHECK(found > reach - 4e-6);
}

}  // namespace wems::identify::updating
