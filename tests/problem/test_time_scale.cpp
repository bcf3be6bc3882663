#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/updating/settling.hpp"
#include "models/tolerances.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/diagnose/too_slow.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;
using namespace wems::identify::updating;

namespace {

/// The same device with all times longer by a factor: forces fall with its square, dashpots with itself.
MountModel slowDown(MountModel model, double factor) {
    for (auto& connection : model.connections)
        for (auto& law : connection.axis) {
            law.stiffness /= factor * factor;
            law.damping /= factor;
            for (Stop& stop : law.stops) stop.stiffness /= factor * factor;
        }
    for (auto& mode : model.bracket) mode.frequency /= factor;
    const double delay = keyOf(ToleranceOf::sensor_delay).standard;
    model.tolerances.set(ToleranceOf::sensor_delay, delay * factor);
    return model;
}

Recording slowDown(Recording recording, double factor) {
    for (double& time : recording.time) time *= factor;
    for (Channel& channel : recording.channels)
        if (channel.name.rfind("load.", 0) == 0)
            for (double& value : channel.values) value /= factor * factor;
    return recording;
}

/// Misfit of all runs at a point, and what the adjustments come to in units of their tolerances.
struct Answer {
    std::vector<double> misfits;
    Eigen::VectorXd adjustments;
    std::vector<std::string> names;
};

Answer ask(const std::vector<Recording>& runs, const MountModel& model) {
    TestProblem problem(runs, {}, model);
    SetState state;
    state.point = problem.believedPoint();
    state.view = problem.view(state.point, state.set);
    Settler(problem).settle(state, 2, true);
    Answer answer{calcMisfits(sumOf(state.view, true), problem.estimateOf(state.point)), {}, {}};
    const Eigen::VectorXd estimate = problem.estimateOf(state.point), deviation = problem.deviations();
    answer.adjustments = (deviation.array() > 0).select(estimate.cwiseQuotient(deviation), 0.0);
    for (const Unknown& row : problem.table()) answer.names.push_back(row.name);
    return answer;
}

}  // namespace

TEST_CASE("The unit of time changes nothing in the adjustments", "[update]") {
    if (test::isTooSlow()) return;
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel model = identify::testing::makeRandomDevice(random);
    MountModel truth = model;
    for (auto& connection : truth.connections)
        for (auto& law : connection.axis) law.stiffness *= std::uniform_real_distribution<double>(0.95, 1.05)(random);
    identify::testing::RunPlan plan;
    plan.duration = 6;
    plan.force = {40, 30, 100};
    const Recording run = identify::testing::recordRun(truth, plan, random);
    // Powers of two are free of rounding, which moves the last bin of a band and with it an adjustment by hundredths.
    const double factor = GENERATE(16.0, 0.0625);
    const Answer here = ask({run}, model), there = ask({slowDown(run, factor)}, slowDown(model, factor));
    REQUIRE(here.misfits.size() == there.misfits.size());
    for (std::size_t k = 0; k < here.misfits.size(); ++k)
        CHECK(there.misfits[k] == Approx(here.misfits[k]).epsilon(1e-6).margin(1e-9));
    CHECK(here.adjustments.cwiseAbs().maxCoeff() > 0.5);
    for (std::size_t i = 0; i < here.names.size(); ++i) {
        CAPTURE(here.names[i]);
        const Eigen::Index row = i;
        CHECK(there.adjustments[row] == Approx(here.adjustments[row]).margin(1e-5));
    }
}
