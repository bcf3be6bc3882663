#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/exact/open_loop_problem.hpp"
#include "identify/exact/screening.hpp"
#include "identify/exact/trial_fits.hpp"
#include "identify/motion/motion.hpp"
#include "models/parameter_access.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

constexpr double kScatter = 1e-3;

OpenLoopProblem makeProblem(const MountModel& truth, const MountModel& believed, std::mt19937_64& random) {
    identify::testing::RunPlan plan;
    plan.force = {40, 30, 60};
    const auto motion = estimateMotion(identify::testing::recordRun(truth, plan, random), believed);
    return {{makeOpenLoopRun(motion, believed, {5, 50}, {})}, believed, kScatter};
}

}  // namespace

TEST_CASE("Calibration scatter does not explain away what is far above the noise", "[diagnose]") {
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const auto truth = identify::testing::makeRandomDevice(random);
    MountModel believed = truth;
    believed.body.center_of_gravity.z() -= 0.1;
    auto problem = makeProblem(truth, believed, random);
    // Gains of zero would solve the equations: they must cost more than the residual itself is worth.
    const auto residual = problem.calcResidual(believed);
    const double square = residual.values.cast<double>().squaredNorm() / static_cast<double>(problem.size());
    CHECK(problem.calcMisfit(residual) > 0.3 * square);

    const auto knob = makeKnob("body.center_of_gravity.z");
    const auto first = fitParameters(problem, believed, {knob});
    CHECK(first.values[0] == Approx(truth.body.center_of_gravity.z()).margin(1e-3));
    // With the noise of the model that was found, a perfect model leaves 1. Its standard deviation is below 0.02.
    problem.rewhiten(first.model);
    CHECK(std::abs(fitParameters(problem, first.model, {knob}).misfit - 1) < 0.15);
}

TEST_CASE("A change of law seen along its axis is the exact one but for small rotations", "[diagnose]") {
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const auto model = identify::testing::makeRandomDevice(random);
    const auto problem = makeProblem(model, model, random);
    const LawDifferences laws(problem, model);
    for (const char* name : {"1.z.stiffness", "2.x.damping", "3.y.friction_force", "1.z.loss_factor"}) {
        CAPTURE(name);
        MountModel changed = model;
        setParameter(changed, name, getParameter(model, name) + parameterScale(model, name));
        const auto exact = problem.calcDifference(model, changed), quick = laws.calc(model, changed);
        CHECK((exact.values - quick.values).norm() < 0.05F * exact.values.norm());
        CHECK((exact.calibration - quick.calibration).norm() < 0.05 * exact.calibration.norm());
        CHECK(laws.calc(model, changed).values == quick.values);
    }
    CHECK(laws.calc(model, model).isZero());
}
