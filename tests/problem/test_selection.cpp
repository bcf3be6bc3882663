// What becomes a cause where numbers have tolerances: the equations of a recorded run, and a prediction whose error the
// test prescribes.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "identify/updating/naming.hpp"
#include "identify/updating/selection.hpp"
#include "models/parameter_access.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/seed.hpp"

namespace wems::identify::updating {
namespace {

Recording recordIt(const MountModel& truth, std::mt19937_64& random) {
    identify::testing::RunPlan plan;
    plan.duration = 4;
    plan.force = Eigen::Vector3d(40, 30, 60);
    return recordRun(truth, plan, random);
}

constexpr double kLittle = 0.02;  // error of a prediction that asks for nothing

FreeError predictLittle(const TestPoint& /*point*/, const HypothesisSet& /*set*/) {
    return {kLittle, kLittle};
}

}  // namespace

TEST_CASE("A number beyond its tolerance has a name where the prediction needs it there", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const char* const key = "1.z.stiffness";
    const MountModel believed = identify::testing::makeRandomDevice(random);
    MountModel truth = believed;
    setParameter(truth, key, 1.4 * getParameter(truth, key));
    const Recording recording = recordIt(truth, random);
    const auto find = [&](double error) {
        TestProblem problem({recording}, {}, believed);
        const int row = findUnknown(problem.table(), key);
        const Unknown number = problem.table()[row];
        // The prediction is worse with the name.
        const FreeJudge judge = [&](const TestPoint& point, const HypothesisSet& set) -> FreeError {
            const bool beyond = std::abs(point.values[row] - number.believed) > 2.01 * number.deviation;
            return {(beyond ? 1.0 : 5.0) * (set.empty() ? 1.0 : 1.1) * error, 0.1 * kLittle};
        };
        return describe(problem, selectCauses(problem, judge, {}, {}).state.set);
    };
    // About the jumps of a sweep a prediction is some per cent better or worse for no reason.
    const std::vector<std::string> causes = find(kLittle);
    CAPTURE(causes);
    REQUIRE(causes.size() == 1);
    CHECK(causes.front() == "elastomer_stiffness 1.z");
    // One that asks for a cause is not explained by what makes it worse.
    CHECK(find(5 * kLittle).empty());
}

TEST_CASE("A mechanism that halves what the equations leave is a cause though the prediction is as good",
          "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel believed = identify::testing::makeRandomDevice(random);
    MountModel truth = believed;
    for (auto& connection : truth.connections) connection.axis[2].drift = -0.02;
    const auto find = [&](const MountModel& device) {
        TestProblem problem({recordIt(device, random)}, {}, believed);
        const Selection selection = selectCauses(problem, predictLittle, {}, {});
        for (const Decision& decision : selection.decisions) {
            const auto taken = std::count_if(decision.fitted.begin(), decision.fitted.end(),
                                             [](const FittedSet& own) { return own.outcome == kTaken; });
            CHECK(taken == (decision.action == "causes changed" ? 1 : 0));
        }
        return describe(problem, selection.state.set);
    };
    const std::vector<std::string> causes = find(truth), none = find(believed);
    CAPTURE(causes, none);
    REQUIRE(causes.size() == 1);
    CHECK(causes.front().rfind("stiffness_drift", 0) == 0);
    CHECK(none.empty());
}

TEST_CASE("Places that move alike share the probability of a mechanism", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    MountModel believed;
    believed.body.mass = 6;
    believed.body.inertia = Eigen::Vector3d(0.05, 0.05, 0.05).asDiagonal();
    believed.body.free = {false, false, true, false, false, false};
    believed.load_point = LoadPoint{Part::mobile, Eigen::Vector3d::Zero()};
    for (const double x : {-0.1, 0.1}) {
        Connection connection;
        connection.name = x < 0 ? "1" : "2";
        connection.position = {x, 0, 0};
        connection.axis[2].stiffness = 7e4;
        connection.axis[2].damping = 30;
        believed.connections.push_back(connection);
    }
    MountModel truth = believed;
    const std::size_t hidden = std::uniform_int_distribution<std::size_t>(0, 1)(random);
    const double ratio = std::uniform_real_distribution<double>(0.2, 0.4)(random);
    truth.connections[hidden].axis[2].relaxation = {{ratio, 0.02}};
    TestProblem problem({recordIt(truth, random)}, {}, believed);
    const Selection selection = selectCauses(problem, predictLittle, {}, {});
    const std::vector<std::string> causes = describe(problem, selection.state.set);
    CAPTURE(hidden, ratio, causes);
    REQUIRE(causes.size() == 1);
    CHECK(causes.front().rfind("relaxation", 0) == 0);
    // The recording holds the sum of both forces alone.
    struct Single {
        double log_evidence = 0, ratio = 0;
    };
    const auto find = [&](const std::string& place) {
        const auto found = std::find_if(selection.ranked.begin(), selection.ranked.end(), [&](const RankedSet& entry) {
            return entry.members.size() == 1 &&
                   describe(problem.hypotheses()[entry.members.front()]) == "relaxation " + place;
        });
        CAPTURE(place);
        REQUIRE(found != selection.ranked.end());
        const bool taken = found->members == selection.state.set;
        const TestPoint& point = taken ? selection.state.point : selection.settled.at(found->members);
        const int row = findUnknown(problem.table(), place + ".stiffness_ratio");
        return Single{found->log_evidence, point.values[row]};
    };
    const Single left = find("1.z"), right = find("2.z");
    CHECK(left.log_evidence == Approx(right.log_evidence).margin(0.5));
    // The ratio moves with the stiffness, which has its tolerance.
    CHECK(left.ratio == Approx(ratio).epsilon(0.5));
    CHECK(right.ratio == Approx(ratio).epsilon(0.5));
}

TEST_CASE("Intervals of the identification runs do not know what the validation runs leave", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel believed = identify::testing::makeRandomDevice(random);
    MountModel other = believed;
    other.body.mass *= 1.5;
    const TestProblem problem({recordIt(believed, random)}, {recordIt(other, random)}, believed);
    const Settler settler(problem);
    SetState state;
    state.point = problem.believedPoint();
    state.view = problem.view(state.point, state.set);
    settler.settle(state, 3, false);
    const std::size_t mount = indexOf(Block::mount);
    CHECK(state.scales[mount].scale == Approx(1).epsilon(0.5));
    const std::vector<double> all = calcMisfits(sumOf(state.view, true), problem.estimateOf(state.point));
    CHECK(settler.scalesOf(all)[mount].scale > 3);
}

}  // namespace wems::identify::updating
