#include <catch2/catch.hpp>
#include <random>

#include "identify/updating/test_problem.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/diagnose/too_slow.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;
using namespace wems::identify::updating;

// Small steps of every kind of number: the misfit, weighed by the same covariance, follows the quadratic.
TEST_CASE("The quadratic of an information is the misfit about its state", "[linearised run]") {
    if (test::isTooSlow()) return;
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel model = identify::testing::makeRandomDevice(random);
    identify::testing::RunPlan plan;
    plan.duration = 8;
    plan.force = {20, 30, 120};
    const TestProblem problem({recordRun(model, plan, random)}, {}, model);
    const TestView view = problem.view(problem.believedPoint());
    const double blocks = static_cast<double>(view.identification[0].count);
    REQUIRE(blocks > 0);
    const Information base = problem.misfit(view.at, view).identification;
    const auto& table = problem.table();
    int tried = 0;
    for (std::size_t i = 0; i < table.size(); ++i) {
        const Unknown& row = table[i];
        // Sensors' columns hold less noise than their channels; see selection.cpp.
        if (row.kind >= UnknownKind::channel_gain || row.believed == row.least) continue;
        const auto column = static_cast<Eigen::Index>(i);
        const double A = view.identification[0].A(column, column);
        if (!(A > 0)) continue;
        // A change that the data see at ten times their noise, but no more than a thousandth of the reach.
        const double step = std::min(10 / std::sqrt(A), 1e-3 * row.reach);
        Eigen::VectorXd estimate = Eigen::VectorXd::Zero(problem.deviations().size());
        estimate[column] = step;
        const Information moved = problem.misfit(problem.pointAt(estimate, {}), view).identification;
        const double expected = 2 * view.identification[0].b[column] * step + A * step * step;
        CAPTURE(row.name, step, A);
        CHECK(moved[0].chi_squared - base[0].chi_squared ==
              Approx(expected).margin(0.05 * std::abs(A) * step * step + 0.05));
        ++tried;
    }
    CHECK(tried > 30);
}
