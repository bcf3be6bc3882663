// Steps of one set of causes, each borne out by the equations: they lead to the truth, or nowhere worse.
#include <catch2/catch.hpp>
#include <random>
#include <string>

#include "identify/updating/settling.hpp"
#include "models/parameter_access.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/seed.hpp"

namespace wems::identify::updating {
namespace {

int findHypothesis(const TestProblem& problem, const std::string& cause, const std::string& where) {
    const auto& all = problem.hypotheses();
    for (std::size_t h = 0; h < all.size(); ++h)
        if (all[h].cause == cause && all[h].where == std::vector<std::string>{where}) return static_cast<int>(h);
    return -1;
}

}  // namespace

// Of a stop that is pressed deeply a clearance is bent: as it falls, contact is deeper, and with the stiffness that
// acts the noise grows which the equations have.
TEST_CASE("Steps lead to the clearance of a stop that is pressed deeply", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const auto draw = [&](double lower, double upper) {
        return std::uniform_real_distribution<double>(lower, upper)(random);
    };
    const std::string name = "1.z.+.clearance";
    const MountModel believed = identify::testing::makeRandomDevice(random);
    MountModel truth = believed;
    const double clearance = draw(0.3, 0.6) * getParameter(believed, name);
    setParameter(truth, name, clearance);
    identify::testing::RunPlan plan;
    plan.duration = 4;
    plan.force = Eigen::Vector3d(40, 30, 200);
    const TestProblem problem({identify::testing::recordRun(truth, plan, random)}, {}, believed, Numbers::exact);
    const Settler settler(problem);
    const int row = findUnknown(problem.table(), name);
    SetState state;
    state.set = {findHypothesis(problem, "clearance", "1.z.+")};
    REQUIRE(state.set.front() >= 0);
    for (const double begin : {draw(0.5, 0.8), draw(1.2, 1.4)}) {
        CAPTURE(begin);
        Eigen::VectorXd estimate = Eigen::VectorXd::Zero(problem.deviations().size());
        estimate[row] = begin * clearance - problem.table()[row].believed;
        state.point = problem.pointAt(estimate, state.set);
        state.view = problem.view(state.point, state.set);
        settler.settle(state, 12, true);
        CHECK(isSatisfied(calcMisfits(sumOf(state.view, true), problem.estimateOf(state.point))));
        CHECK(state.point.values[row] == Approx(clearance).epsilon(0.005));
    }
}

}  // namespace wems::identify::updating
