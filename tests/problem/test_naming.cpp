// What equations that leave much beyond the noise say of a number, told from quadratics whose misfits are known by
// construction.
#include <Eigen/Core>
#include <catch2/catch.hpp>
#include <random>

#include "identify/updating/naming.hpp"
#include "identify/verdict/free_error.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/seed.hpp"

using namespace wems::identify;

namespace {

constexpr double kCount = 1000;

/// A block that leaves `left` per value at ε = 1 and `without` at ε = 0: χ² = n (left + (without − left) (ε − 1)²).
BlockInformation makeBlock(double left, double without) {
    BlockInformation block;
    const double gained = kCount * (without - left);
    block.A = Eigen::MatrixXd::Constant(1, 1, gained);
    block.b = Eigen::VectorXd::Constant(1, -gained);
    block.chi_squared = kCount * without;
    block.count = kCount;
    return block;
}

Information pair(const BlockInformation& mount, const BlockInformation& sensors) {
    Information all;
    all[indexOf(Block::mount)] = mount;
    all[indexOf(Block::mobile_sensors)] = sensors;
    return all;
}

const Eigen::VectorXd kWith = Eigen::VectorXd::Ones(1), kWithout = Eigen::VectorXd::Zero(1);

}  // namespace

TEST_CASE("Naming: the quadratics of this test leave what they say") {
    const BlockInformation block = makeBlock(2, 7);
    CHECK(calcBlockMisfit(block, kWith) == Approx(2));
    CHECK(calcBlockMisfit(block, kWithout) == Approx(7));
}

TEST_CASE("Naming: half of what exceeds the noise, of a block that is not satisfied") {
    CHECK(updating::takesHalf(pair(makeBlock(100, 200), makeBlock(1, 1)), kWith, kWithout));
    CHECK_FALSE(updating::takesHalf(pair(makeBlock(100, 198), makeBlock(1, 1)), kWith, kWithout));
    CHECK(updating::takesHalf(pair(makeBlock(1, 1), makeBlock(4, 7)), kWith, kWithout));
    CHECK_FALSE(updating::takesHalf(pair(makeBlock(1, 1), makeBlock(2, 7)), kWith, kWithout));
}

TEST_CASE("Naming: noise alone, of every block") {
    const auto is = [](double mount, double sensors) {
        const Information all = pair(makeBlock(mount, mount), makeBlock(sensors, sensors));
        return updating::isNoiseAlone(all, updating::calcMisfits(all, kWith));
    };
    // Of 1000 values a perfect model leaves 1 ± √(2/1000) each.
    CHECK(is(1, 1));
    CHECK(is(0.5, 1.08));
    CHECK_FALSE(is(1.1, 1));
    CHECK_FALSE(is(1, 1.1));
}

TEST_CASE("Naming: noise alone, as far as its level is known") {
    const auto is = [](double misfit, Eigen::Index bands) {
        BlockInformation block = makeBlock(misfit, misfit);
        block.noise_slopes = Eigen::MatrixXd::Zero(1, bands);
        const Information all = pair(block, makeBlock(1, 1));
        return updating::isNoiseAlone(all, updating::calcMisfits(all, kWith));
    };
    // 1.96 √(2/1000 + 0.3²/bands) beyond 1: 0.31 of four bands, 0.17 of sixteen.
    CHECK(is(1.28, 4));
    CHECK_FALSE(is(1.34, 4));
    CHECK(is(1.15, 16));
    CHECK_FALSE(is(1.2, 16));
}

TEST_CASE("Naming: a cause's part of the error is less than a twentieth, or less than the noise") {
    CHECK(isWorthless({0.1, 0}, {0.104, 0}));
    CHECK_FALSE(isWorthless({0.1, 0}, {0.106, 0}));
    // Without it √(0.1² + 0.05²) = 0.112 where the noise is half of what is left.
    CHECK(isBelowNoise({0.1, 0.05}, {0.11, 0.05}));
    CHECK_FALSE(isBelowNoise({0.1, 0.05}, {0.114, 0.05}));
}

TEST_CASE("Naming: numbers beyond their tolerances give back what they cost") {
    const unsigned seed = wems::test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const wems::MountModel model = testing::makeRandomDevice(random);
    testing::RunPlan plan;
    plan.duration = 2;
    plan.force = {40, 30, 60};
    const updating::TestProblem problem({recordRun(model, plan, random)}, {}, model);
    const auto own = static_cast<int>(findUnknown(problem.table(), "1.z.stiffness")),
               other = static_cast<int>(findUnknown(problem.table(), "2.z.stiffness"));
    const auto at = [&](double first, double second) {
        updating::SetState state;
        state.point = problem.believedPoint();
        state.point.values[own] += first * problem.table()[own].deviation;
        state.point.values[other] += second * problem.table()[other].deviation;
        return state;
    };
    updating::SetState named = at(-7, 0);
    for (int h = 0; h < static_cast<int>(problem.hypotheses().size()); ++h)
        if (updating::describe(problem.hypotheses()[h]) == "elastomer_stiffness 1.z") named.set = {h};
    REQUIRE(named.set.size() == 1);
    // A normal prior, in log: half of the square. What lies within two deviations has nothing to give.
    CHECK(updating::calcRelief(problem, at(-7, 1.9), at(1, 0)) == Approx(0.5 * (49 - 1)));
    CHECK(updating::calcRelief(problem, at(-7, 3), at(-7, 0)) == Approx(0.5 * 9));
    CHECK(updating::calcRelief(problem, at(-7, 0), named) == Approx(0.5 * (49 - 1)));
    CHECK(updating::calcRelief(problem, named, at(0, 0)) == Approx(0).margin(1e-12));
    CHECK(updating::calcRelief(problem, at(3, 0), at(7, 0)) == Approx(0.5 * (9 - 49)));
}
