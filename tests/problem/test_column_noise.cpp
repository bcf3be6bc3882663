// Slopes of the noise by sums that columns share, against those of each column's own terms.
#include <catch2/catch.hpp>
#include <random>

#include "identify/problem/column_noise.hpp"
#include "identify/problem/lineariser.hpp"
#include "identify/updating/test_problem.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

void checkAlike(const ColumnNoise::Slope& shared, const ColumnNoise::Slope& own) {
    CHECK((shared - own).norm() <= 1e-9 * own.norm());
    CHECK(shared.norm() > 0);
}

}  // namespace

TEST_CASE("Noise slopes by shared sums are those of each column by itself") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel model = testing::makeRandomDevice(random);
    testing::RunPlan plan;
    plan.duration = 4;
    plan.force = {20, 30, 120};
    const updating::TestProblem problem({recordRun(model, plan, random)}, {}, model);
    const TestState state = problem.believedPoint().state;
    const TestRun& run = problem.runs().front();
    const Lineariser at(run, problem.layout(), state);
    ColumnNoise noise(at.run(), state.model, at.spectra(), at.noise(), at.residual());
    const SensorColumns sensors(run, problem.layout(), at.run(), at.spectra(), at.motionNoise(), problem.table(), {});
    int laws = 0, modes = 0, errors = 0;
    for (std::size_t i = 0; i < problem.table().size(); ++i) {
        const Unknown& row = problem.table()[i];
        CAPTURE(row.name);
        if (row.kind == UnknownKind::law) {
            TestState moved = state;
            row.set(moved, row.get(state) + row.step);
            const auto change = noise.calcLawChange(state, moved, row.first, row.second, row.step);
            if (!change.stiffness) continue;
            ++laws;
            checkAlike(noise.calcSlope(change), noise.calcSlope(noise.makeLaw(change)));
        }
        const bool of_shape = row.kind == UnknownKind::shape && row.second < 9;
        if ((of_shape || row.kind == UnknownKind::mode) &&
            row.first + 1 < static_cast<int>(state.model.bracket.size())) {
            const ColumnNoise::ModeChange change{row.first, row.second + (of_shape ? 2 : 0)};
            ++modes;
            checkAlike(noise.calcSlope(change), noise.calcSlope(noise.makeMode(change)));
        }
        const SensorEffect effect = sensors.calcEffect(i);
        if (effect.changes.empty()) continue;
        ++errors;
        checkAlike(noise.calcSlope(effect), noise.calcSlope(noise.makeSensor(effect)));
    }
    CHECK(laws > 10);
    CHECK(modes == 11 * static_cast<int>(model.bracket.size()));
    CHECK(errors > 10);
}

}  // namespace wems::identify
