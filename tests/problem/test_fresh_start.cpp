#include <algorithm>
#include <catch2/catch.hpp>
#include <random>
#include <string>

#include "identify/updating/fresh_start.hpp"
#include "models/parameter_access.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/seed.hpp"

namespace wems::identify::updating {
namespace {

constexpr double kFar = 8;  // standard deviations: 64 in the prior's square

}  // namespace

TEST_CASE("A preload is begun from the believed stops, not from those that stand for it", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel believed = identify::testing::makeRandomDevice(random);
    const auto last = static_cast<int>(believed.connections.size()) - 1;
    const int hidden = std::uniform_int_distribution<int>(0, last)(random);
    const std::string place = std::to_string(hidden + 1) + ".z";
    const double clearance = believed.connections[hidden].axis[2].stops.front().clearance;
    const double sign = std::bernoulli_distribution(0.5)(random) ? 1 : -1;
    const double offset = sign * std::uniform_real_distribution<double>(0.2, 0.4)(random) * clearance;
    MountModel truth = believed;
    setParameter(truth, place + ".offset", offset);
    identify::testing::RunPlan plan;
    plan.duration = 6;
    plan.force = Eigen::Vector3d(0, 0, 800);  // presses every axial stop
    const TestProblem problem({identify::testing::recordRun(truth, plan, random)}, {}, believed);
    const Settler settler(problem);
    SetState state;
    state.point = problem.believedPoint();
    CAPTURE(place, offset, clearance);
    CHECK(startAfresh(problem, settler, state, state).empty());

    const int stop = findUnknown(problem.table(), place + ".+.clearance");
    Eigen::VectorXd estimate = problem.estimateOf(state.point);
    estimate[stop] = -kFar * problem.table()[stop].deviation;
    state.point = problem.pointAt(estimate, {});
    const std::vector<Trial> starts = startAfresh(problem, settler, state, state);
    const auto preload = std::find_if(starts.begin(), starts.end(), [&](const Trial& trial) {
        return problem.hypotheses()[trial.set.front()].cause == "preload";
    });
    REQUIRE(preload != starts.end());
    CHECK(problem.hypotheses()[preload->set.front()].where.front() == place);
    CHECK(preload->point.values[stop] == Approx(problem.table()[stop].believed));
    const double begun = preload->point.values[findUnknown(problem.table(), place + ".offset")];
    CHECK(begun == Approx(offset).margin(0.25 * clearance));
}

}  // namespace wems::identify::updating
