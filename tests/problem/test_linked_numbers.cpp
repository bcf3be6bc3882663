// Numbers that are off together: what parts alike share of a mechanism.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "identify/updating/linked_numbers.hpp"
#include "identify/updating/settling.hpp"
#include "models/parameter_access.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/seed.hpp"

namespace wems::identify::updating {
namespace {

constexpr int kSteps = 12;

double draw(std::mt19937_64& random, double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
}

HypothesisSet findCommon(const TestProblem& problem, const std::string& cause, const std::vector<std::string>& where) {
    const auto& all = problem.hypotheses();
    for (std::size_t h = 0; h < all.size(); ++h)
        if (all[h].cause == cause && all[h].where == where) return {static_cast<int>(h)};
    return {};
}

}  // namespace

TEST_CASE("A share is known to a part of what it is", "[updating]") {
    Hypothesis hypothesis;
    hypothesis.shares = {{0, 0.05}, {2, 0.1}};
    Eigen::VectorXd deviation = Eigen::Vector3d::Constant(7);
    addShares(hypothesis, Eigen::Vector3d(-2, 3, 4), deviation);
    CHECK(deviation.isApprox(Eigen::Vector3d(0.1, 7, 0.4)));
}

TEST_CASE("A share stays within its tolerance of what is common", "[updating]") {
    Hypothesis hypothesis;
    hypothesis.shares = {{0, 0.05}, {1, 0.05}, {2, 0.1}};
    Eigen::VectorXd estimate = Eigen::Vector4d(-2, -2, 4, 1);
    keepShares(hypothesis, Eigen::Vector4d(-2.1, 0, 5, 3), estimate);
    CHECK(estimate.isApprox(Eigen::Vector4d(-2.1, -1.8, 4.8, 1)));
}

TEST_CASE("A cubic force of all axial elastomers goes with their true stiffnesses", "[updating]") {
    const unsigned seed = wems::test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    MountModel believed = identify::testing::makeRandomDevice(random), truth = believed;
    const double tolerance = draw(random, 0.04, 0.08), size = draw(random, 0.2, 0.6);
    believed.tolerances.set(ToleranceOf::stiffness, tolerance);
    std::vector<std::string> axes, names;
    for (std::size_t i = 0; i < truth.connections.size(); ++i) {
        axes.push_back(truth.connections[i].name + ".z");
        names.push_back(axes.back() + ".cubic");
        AxisLaw& law = truth.connections[i].axis[2];
        law.stiffness *= 1 + draw(random, -tolerance, tolerance);
        law.cubic = size * law.stiffness / std::pow(believed.connections[0].axis[2].stops[0].clearance, 2);
    }
    identify::testing::RunPlan plan;
    plan.duration = 6;
    plan.force = Eigen::Vector3d(20, 15, 90);
    TestProblem problem({identify::testing::recordRun(truth, plan, random)}, {}, believed);
    SetState state;
    state.set = findCommon(problem, "cubic_stiffness", axes);
    REQUIRE(state.set.size() == 1);
    problem.adopt(state.set);
    state.point = problem.pointAt(Eigen::VectorXd::Zero(problem.deviations().size()), state.set);
    state.view = problem.view(state.point, state.set);
    Settler(problem).settle(state, kSteps, true);
    const Information all = sumOf(state.view, true);
    const Posterior posterior =
        SetEvidence(problem, all, state.scales, state.set, problem.estimateOf(state.point)).calcPosterior();
    for (const std::string& name : names) {
        const int row = findUnknown(problem.table(), name);
        REQUIRE(row >= 0);
        const double error = state.point.values[row] - getParameter(truth, name);
        INFO(name << ": " << state.point.values[row] << ", true " << getParameter(truth, name) << ", deviation "
                  << std::sqrt(posterior.covariance(row, row)));
        CHECK(std::abs(error) < 5 * std::sqrt(posterior.covariance(row, row)));
    }
}

}  // namespace wems::identify::updating
