#include <catch2/catch.hpp>
#include <random>

#include "identify/exact/expectation.hpp"
#include "identify/exact/open_loop_problem.hpp"
#include "identify/exact/pass.hpp"
#include "models/parameter_access.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

struct Left {
    double error, misfit;
};

/// What `model` leaves in a recording of `truth`, and what it would leave if it were the truth.
std::pair<Left, Expectation> compare(const MountModel& truth, const MountModel& model, double level,
                                     std::mt19937_64& random) {
    identify::testing::RunPlan plan;
    plan.duration = 6;
    plan.force = level * Eigen::Vector3d(20, 40, 250);
    const RunGroup group({recordRun(truth, plan, random)}, model);
    const OpenLoopProblem problem = group.makeProblem(model);
    return {{calcFreeError(group.free_runs, model).error, problem.calcMisfit(model)},
            calcExpectation(group.motions, model, model)};
}

}  // namespace

TEST_CASE("What a perfect model leaves is expected before it is seen", "[diagnose]") {
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const auto truth = identify::testing::makeRandomDevice(random);
    SECTION("short of the stops: noise and a calibration of 0.1 %, which the recording does not have") {
        const auto [left, expected] = compare(truth, truth, 0.1, random);
        CHECK(left.error < 1.05 * expected.error);
        CHECK(expected.error < 1.5 * left.error + 0.01);
        CHECK(left.misfit == Approx(expected.misfit).margin(0.15));
    }
    SECTION("in the stops, which may amplify beyond what can be expected: the equations tell") {
        const auto [left, expected] = compare(truth, truth, 1, random);
        CHECK(left.misfit < 1 + 3 * (expected.misfit - 1) + 0.15);
    }
    SECTION("a model that is wrong leaves more") {
        MountModel wrong = truth;
        for (const char* name : {"1.z.stiffness", "2.z.stiffness", "3.z.stiffness"})
            setParameter(wrong, name, 0.8 * getParameter(truth, name));
        const auto [left, expected] = compare(truth, wrong, 0.1, random);
        CHECK(left.error > 1.5 * expected.error);
        CHECK(left.misfit > expected.misfit + 0.5);
    }
}
