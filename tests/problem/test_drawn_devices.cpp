// Devices, set-ups and sensors as they are drawn at random: whatever is recorded, the equations can be formed.
#include <catch2/catch.hpp>

#include "identify/updating/test_problem.hpp"
#include "tests/hidden/hidden_recording.hpp"
#include "tests/hidden/random_case.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;
using namespace wems::identify::updating;

TEST_CASE("Whatever is recorded, every number has a column") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    hidden::Random random(seed);
    hidden::CaseOptions options;
    options.level = std::uniform_int_distribution<int>(0, 2)(random);
    options.set_up_kind = GENERATE("bracket", "base", "axis");
    const auto hidden = hidden::drawCase(options, random);
    const TestProblem problem({hidden::recordRun(hidden, 0, seed), hidden::recordRun(hidden, 1, seed)}, {},
                              hidden.base);
    const TestView view = problem.view(problem.believedPoint(), {});
    for (const BlockInformation& block : view.identification) {
        CHECK(block.A.allFinite());
        CHECK(block.b.allFinite());
    }
    CHECK_FALSE(view.identification[indexOf(Block::mount)].empty());
}
