// Columns of an earlier point at a further one: the equations are those of the point itself.
#include <catch2/catch.hpp>
#include <random>

#include "identify/updating/settling.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/seed.hpp"

namespace wems::identify::updating {
namespace {

TestProblem makeProblem(std::mt19937_64& random) {
    const MountModel model = identify::testing::makeRandomDevice(random);
    identify::testing::RunPlan plan;
    plan.duration = 4;
    plan.force = {40, 30, 200};
    return {{recordRun(model, plan, random)}, {}, model};
}

/// All numbers elsewhere within their tolerances.
TestPoint drawPoint(const TestProblem& problem, std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    Eigen::VectorXd estimate = problem.deviations();
    for (double& own : estimate) own *= normal(random);
    return problem.pointAt(estimate, {});
}

/// Of a block's slopes, each over the root of its curvature.
Eigen::VectorXd scaledSlopes(const TestView& view, Block block) {
    const BlockInformation& own = view.runs.front().information[indexOf(block)];
    return (own.A.diagonal().array() > 0).select(own.b.array() * own.A.diagonal().array().rsqrt(), 0.0);
}

constexpr Block kAll[] = {Block::mount, Block::bracket, Block::mobile_sensors, Block::fixed_sensors};

}  // namespace

TEST_CASE("Held columns say at their own point what they said", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const TestProblem problem = makeProblem(random);
    const TestPoint point = drawPoint(problem, random);
    const TestView formed = problem.view(point, HypothesisSet{});
    const TestView held = problem.follow(formed, point, {}, problem.misfit(point));
    REQUIRE(held.held);
    for (const Block block : kAll) {
        CAPTURE(indexOf(block));
        const BlockInformation &own = held.identification[indexOf(block)],
                               &other = formed.identification[indexOf(block)];
        CHECK(own.A == other.A);
        CHECK(own.chi_squared == Approx(other.chi_squared).epsilon(1e-6));
        // Columns are of single precision.
        const double size = std::sqrt(held.runs.front().information[indexOf(block)].chi_squared);
        CHECK((scaledSlopes(held, block) - scaledSlopes(formed, block)).cwiseAbs().maxCoeff() < 1e-5 * size);
    }
}

TEST_CASE("Held columns have most of the slopes of a further point", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const TestProblem problem = makeProblem(random);
    const TestView formed = problem.view(problem.believedPoint(), HypothesisSet{});
    Eigen::VectorXd estimate = 0.2 * problem.estimateOf(drawPoint(problem, random));
    const TestPoint further = problem.pointAt(estimate, {});
    const TestView held = problem.follow(formed, further, {}, problem.misfit(further));
    const TestView anew = problem.view(further, HypothesisSet{});
    REQUIRE(held.held);
    REQUIRE_FALSE(anew.held);
    for (const Block block : kAll) {
        CAPTURE(indexOf(block));
        CHECK(held.runs.front().information[indexOf(block)].chi_squared ==
              Approx(anew.runs.front().information[indexOf(block)].chi_squared).epsilon(1e-4));
        const Eigen::VectorXd there = scaledSlopes(anew, block);
        const double wrong = (scaledSlopes(held, block) - there).norm(),
                     moved = (there - scaledSlopes(formed, block)).norm();
        CAPTURE(wrong, moved);
        CHECK(wrong < 0.3 * moved);
    }
}

TEST_CASE("What has come to rest has the columns of its own point", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const TestProblem problem = makeProblem(random);
    const Settler settler(problem);
    SetState state;
    state.point = drawPoint(problem, random);
    state.view = problem.view(state.point, state.set);
    for (const int most : {1, 2, 16}) {
        CAPTURE(most);
        SetState end = state;
        settler.settle(end, most, true);
        CHECK_FALSE(end.view.held);
        CHECK(end.view.at.values == end.point.values);
        const TestView anew = problem.view(end.point, end.set);
        for (const Block block : kAll)
            CHECK(end.view.identification[indexOf(block)].A == anew.identification[indexOf(block)].A);
    }
}

}  // namespace wems::identify::updating
