#include <Eigen/Dense>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "identify/updating/test_problem.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;
using namespace wems::identify::updating;

namespace {

/// Displacements of a device without noise, in a sweep of 12 s.
Recording recordExact(const MountModel& model, const Eigen::Vector3d& force, std::mt19937_64& random) {
    identify::testing::RunPlan plan;
    plan.duration = 12;
    plan.force = force;
    plan.noise = 1e-15;
    return recordRun(model, plan, random);
}

/// The displacements with noise of their own.
Recording addNoise(Recording recording, double deviation, std::mt19937_64& random) {
    std::normal_distribution<double> normal(0, deviation);
    for (Channel& channel : recording.channels)
        if (channel.unit == "m")
            for (double& value : channel.values) value += normal(random);
    return recording;
}

/// Slope of a block's misfit at the state of a view, noise taken off, over what one standard deviation of each column
/// makes of it.
Eigen::VectorXd calcScores(const BlockInformation& block, Eigen::Index rows) {
    const Eigen::VectorXd slope = block.b - block.noise_slopes.rowwise().sum();
    Eigen::VectorXd scores = Eigen::VectorXd::Zero(rows);
    for (Eigen::Index i = 0; i < rows; ++i)
        if (block.A(i, i) > 0) scores[i] = slope[i] / std::sqrt(block.A(i, i));
    return scores;
}

}  // namespace

// At the truth the slope of the misfit is noise, with standard deviations of 0.3 to 1.3 of √A: whatever is left in the
// mean of many draws of the noise is wrong in the equations. The mean of six lies within five standard deviations but
// for once in 2000 seeds. Second derivatives that were wrong by 3e-4 showed means up to 13 here.
TEST_CASE("At the truth nothing but noise moves any number", "[scores]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel model = identify::testing::makeRandomDevice(random);
    const Recording exact = recordExact(model, {2, 3, 8}, random);  // clear of the stops
    constexpr int draws = 6;
    std::vector<Eigen::VectorXd> mean(2);
    std::vector<std::string> names;
    for (int draw = 0; draw < draws; ++draw) {
        const TestProblem problem({addNoise(exact, 5e-7, random)}, {}, model);
        const TestView view = problem.view(problem.believedPoint());
        const Eigen::Index rows = problem.table().size();
        for (std::size_t block = 0; block < 2; ++block) {
            const Eigen::VectorXd scores = calcScores(view.identification[block], rows) / draws;
            mean[block] = draw == 0 ? scores : Eigen::VectorXd(mean[block] + scores);
        }
        if (draw > 0) continue;
        for (const Unknown& row : problem.table()) names.push_back(row.name);
    }
    for (std::size_t block = 0; block < 2; ++block)
        for (std::size_t i = 0; i < names.size(); ++i) {
            CAPTURE(block, names[i]);
            CHECK(std::abs(mean[block][i]) < 5 * 1.3 / std::sqrt(draws));
        }
}

// What noise leaves in contact comes in bursts, in every column that has a part there: A alone knew too much of
// masses, stiffnesses and sensors beside a stop, and moved the stop to fit. Three seeds: 1.1 to 1.8 with bursts, 2.6 to
// 7.4 by A alone; the columns hang together, so that a mean over them all scatters as a few values do.
TEST_CASE("In contact noise moves all numbers as bursts do", "[scores]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel model = identify::testing::makeRandomDevice(random);
    const Recording exact = recordExact(model, {20, 30, 200}, random);
    constexpr int draws = 8;
    double by_bursts = 0, by_even = 0, count = 0;
    for (int draw = 0; draw < draws; ++draw) {
        const TestProblem problem({addNoise(exact, 5e-6, random)}, {}, model);
        const TestView view = problem.view(problem.believedPoint());
        const BlockInformation& block = view.identification[indexOf(Block::mount)];
        const Eigen::VectorXd slope = block.b - block.noise_slopes.rowwise().sum();
        for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(problem.table().size()); ++i) {
            if (!(block.A(i, i) > 0)) continue;
            by_bursts += slope[i] * slope[i] / (block.A(i, i) + block.scatter(i, i));
            by_even += slope[i] * slope[i] / block.A(i, i);
            ++count;
        }
    }
    CAPTURE(by_bursts / count, by_even / count);
    CHECK(by_bursts < 3 * count);
    CHECK(by_bursts > 0.3 * count);
    CHECK(by_bursts < 0.8 * by_even);
}
