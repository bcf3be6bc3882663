// Which blocks of a long recording a fit sees: against the best of all sets, and in what the fit then knows.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/fit/block_choice.hpp"
#include "models/parameter_access.hpp"
#include "tests/fit/synthetic_run.hpp"

namespace wems::identify {
namespace {

constexpr test::SensorNoise sensors{1e-6, 0.01};

MountModel makeDevice() {
    return readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
}

/// Blocks of `rows` rows of fast sweeps of this force.
std::vector<RunMotion> makeBlocks(const Eigen::Vector3d& force, std::size_t rows, std::uint64_t seed) {
    const MountModel model = makeDevice();
    test::SweepSettings settings;
    settings.force = force;
    settings.octaves_per_minute = 64;
    const Recording whole = test::record(test::simulateSweep(model, settings), sensors, seed);
    std::vector<RunMotion> blocks;
    for (std::size_t first = 0; first + rows <= whole.sampleCount(); first += rows) {
        const auto cut = [&](const std::vector<double>& v) {
            return std::vector<double>(v.begin() + static_cast<std::ptrdiff_t>(first),
                                       v.begin() + static_cast<std::ptrdiff_t>(first + rows));
        };
        Recording block = whole;
        block.time = cut(whole.time);
        for (Channel& channel : block.channels) channel.values = cut(channel.values);
        blocks.push_back(estimateMotion(block, model));
    }
    return blocks;
}

double calcLevelOf(const std::vector<RunMotion>& blocks, const std::vector<std::size_t>& chosen) {
    BlockChoice choice(makeDevice(), {}, chosen.size());
    for (const std::size_t i : chosen) choice.offer(blocks[i]);
    return choice.calcLevel();
}

}  // namespace

TEST_CASE("One pass keeps nearly the best set of blocks") {
    const unsigned seed = 5;
    INFO("seed " << seed);
    std::mt19937 random(seed);
    std::vector<RunMotion> blocks;
    for (const Eigen::Vector3d& force : {Eigen::Vector3d(0, 0, 30), Eigen::Vector3d(0, 0, 400),
                                         Eigen::Vector3d(150, 0, 0), Eigen::Vector3d(0, 150, 0)})
        for (RunMotion& block : makeBlocks(force, 2500, random())) blocks.push_back(std::move(block));
    std::shuffle(blocks.begin(), blocks.end(), random);
    REQUIRE(blocks.size() >= 8);
    blocks.resize(8);
    BlockChoice choice(makeDevice(), {}, 3);
    for (const RunMotion& block : blocks) choice.offer(block);
    CHECK(choice.offeredCount() == 8);
    CHECK(choice.keptCount() == 3);
    double best = -1e9, sum = 0;
    int sets = 0;
    for (std::size_t a = 0; a < blocks.size(); ++a)
        for (std::size_t b = a + 1; b < blocks.size(); ++b)
            for (std::size_t c = b + 1; c < blocks.size(); ++c, ++sets) {
                const double level = calcLevelOf(blocks, {a, b, c});
                best = std::max(best, level);
                sum += level;
            }
    // D-efficiency: the determinant's root for each parameter.
    const auto parameters = static_cast<double>(choice.parameterCount());
    const double efficiency = std::exp((choice.calcLevel() - best) / parameters);
    CAPTURE(choice.calcLevel(), best, sum / sets, efficiency);
    CHECK(efficiency <= 1 + 1e-9);
    CHECK(efficiency > 0.95);
    CHECK(choice.calcLevel() > sum / sets);
    CHECK(choice.calcCost().median >= 1);
    CHECK(choice.calcCost().largest >= choice.calcCost().median);
    const auto chosen = choice.takeBlocks();
    CHECK(chosen.size() == 3);
}

TEST_CASE("With room for all, all blocks are kept in their order, at no cost") {
    const auto blocks = makeBlocks({0, 0, 200}, 2000, 3);
    REQUIRE(blocks.size() >= 2);
    BlockChoice choice(makeDevice(), {}, 100);
    for (const RunMotion& block : blocks) choice.offer(block);
    CHECK(choice.calcCost().largest == Approx(1));
    const auto kept = choice.takeBlocks();
    REQUIRE(kept.size() == blocks.size());
    for (std::size_t i = 0; i < kept.size(); ++i) CHECK(kept[i].time == blocks[i].time);
}

TEST_CASE("The rare block in which a stop is reached is kept") {
    const unsigned seed = 9;
    INFO("seed " << seed);
    std::mt19937 random(seed);
    const auto quiet = makeBlocks({0, 0, 100}, 2500, random()), loud = makeBlocks({0, 0, 500}, 2500, random());
    const auto reach = [](const RunMotion& block) { return (block.mobile.p - block.fixed.p).cwiseAbs().maxCoeff(); };
    const auto hit = std::max_element(loud.begin(), loud.end(),
                                      [&](const RunMotion& a, const RunMotion& b) { return reach(a) < reach(b); });
    BlockChoice choice(makeDevice(), {}, 2);
    for (int round = 0; round < 5; ++round) {
        for (const RunMotion& block : quiet) choice.offer(block);
        if (round == 2) choice.offer(*hit);
    }
    double farthest = 0;
    for (const RunMotion& block : choice.takeBlocks()) farthest = std::max(farthest, reach(block));
    CHECK(farthest == reach(*hit));
}

}  // namespace wems::identify
