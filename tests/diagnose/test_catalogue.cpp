#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>

#include "identify/updating/test_problem.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/hidden/random_case.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;
using namespace wems::identify::updating;

TEST_CASE("Every hypothesis can be tried, is documented, and is met by the hidden cases", "[diagnose]") {
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel model = identify::testing::makeRandomDevice(random);
    identify::testing::RunPlan plan;
    plan.duration = 4;
    plan.force = Eigen::Vector3d(20, 40, 250);
    plan.noise = 1e-6;
    const TestProblem problem({recordRun(model, plan, random)}, {}, model, Numbers::exact);
    std::ifstream stream(WEMS_SOURCE_DIR "/identify/diagnose/README.md");
    const std::string document(std::istreambuf_iterator<char>(stream), {});
    const auto columns = problem.deviations().size();
    double odds = 0;
    for (std::size_t h = 0; h < problem.hypotheses().size(); ++h) {
        const Hypothesis& hypothesis = problem.hypotheses()[h];
        CAPTURE(hypothesis.cause, hypothesis.where);
        const auto& causes = hidden::listCauses();
        CHECK(std::count(causes.begin(), causes.end(), hypothesis.cause) == 1);
        CHECK_THAT(document, Catch::Contains("`" + hypothesis.cause + "`"));
        CHECK_FALSE(hypothesis.where.empty());
        REQUIRE_FALSE(hypothesis.directions.empty());
        odds += std::exp(hypothesis.log_prior);
        Eigen::VectorXd estimate = Eigen::VectorXd::Zero(columns);
        for (const Direction& direction : hypothesis.directions)
            for (const auto& [column, weight] : direction) {
                REQUIRE(column < columns);
                CHECK((weight != 0 && std::isfinite(weight)));
                estimate[column] += 0.1 * weight;
            }
        // A little along all its directions changes the model, or what the sensors have wrong, or neither only where
        // nothing was sought yet.
        const HypothesisSet set{static_cast<int>(h)};
        const TestPoint moved = problem.pointAt(estimate, set);
        const bool changed = (moved.values - problem.believedPoint().values).cwiseAbs().maxCoeff() > 0;
        CHECK((changed || (hypothesis.cause == "bracket_mode" && hypothesis.reported.empty())));
        CHECK((problem.reduce(moved, {}).values - problem.believedPoint().values).isZero(1e-12));
    }
    CHECK(odds == Approx(1));  // the causes share them, and the places of each
}
