#include <catch2/catch.hpp>
#include <random>
#include <string>

#include "identify/updating/test_problem.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;
using namespace wems::identify::updating;

// Small steps of every kind of number: the misfit, weighed by each point's own covariance, follows the quadratic
// without what the columns' noise adds to it. That is known in the mean; a draw of it is off by up to half of what one
// standard deviation of the number changes, and by its bursts in contact.
TEST_CASE("The quadratic of an information is the misfit about its state", "[linearised run]") {
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
    const Information base = problem.misfit(view.at).identification;
    const BlockInformation& mount = view.identification[0];
    const Eigen::VectorXd noise_slope = mount.noise_slopes.rowwise().sum();
    const double level = mount.chi_squared / mount.count;
    const auto& table = problem.table();
    int tried = 0;
    for (std::size_t i = 0; i < table.size(); ++i) {
        const Unknown& row = table[i];
        // Sensors' columns hold less noise than their channels; see selection.cpp.
        if (row.kind >= UnknownKind::channel_gain || row.believed == row.least) continue;
        const Eigen::Index column = i;
        const double A = view.identification[0].A(column, column);
        if (!(A > 0)) continue;
        // A change that the data see at ten times their noise, but no more than a thousandth of the reach.
        const double step = std::min(10 / std::sqrt(A), 1e-3 * row.reach);
        Eigen::VectorXd estimate = Eigen::VectorXd::Zero(problem.deviations().size());
        estimate[column] = step;
        const Information moved = problem.misfit(problem.pointAt(estimate, {})).identification;
        const double expected = 2 * (mount.b[column] - noise_slope[column]) * step +
                                (A - std::min(1.0, level) * mount.noise(column, column)) * step * step;
        const double burst = mount.scatter.size() > 0 ? mount.scatter(column, column) : 0;
        CAPTURE(row.name, step, A, burst);
        CHECK(moved[0].chi_squared - base[0].chi_squared ==
              Approx(expected).margin(0.05 * A * step * step + std::sqrt(0.36 * A + burst) * step + 0.05));
        ++tried;
    }
    CHECK(tried > 30);
}

// A common factor on all forces of the mount makes the residual itself its column: what the noise adds to its product
// with the residual is then the residual's square, and to its own square the number of values, whatever the spectra.
TEST_CASE("A factor on all forces is known by nothing but noise", "[linearised run]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel model = identify::testing::makeRandomDevice(random);
    identify::testing::RunPlan plan;
    plan.duration = 8;
    plan.force = {2, 3, 4};  // clear of the stops
    const TestProblem problem({recordRun(model, plan, random)}, {}, model);
    const TestView view = problem.view(problem.believedPoint());
    const BlockInformation& mount = view.identification[0];
    Eigen::VectorXd factor = Eigen::VectorXd::Zero(problem.deviations().size());
    const auto endsWith = [](const std::string& name, const std::string& end) {
        return name.size() >= end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
    };
    for (std::size_t i = 0; i < problem.table().size(); ++i) {
        const Unknown& row = problem.table()[i];
        const bool law =
            row.kind == UnknownKind::law && (endsWith(row.name, "stiffness") || endsWith(row.name, "damping"));
        if (law || row.name == "body.mass" || row.name.rfind("body.inertia.", 0) == 0) factor[i] = row.believed;
    }
    // The column is the residual.
    CHECK(factor.dot(mount.b) == Approx(mount.chi_squared).epsilon(0.01));
    CHECK(factor.dot(mount.A * factor) == Approx(mount.chi_squared).epsilon(0.01));
    CHECK(factor.dot(mount.noise_slopes.rowwise().sum()) == Approx(mount.chi_squared).epsilon(0.01));
    // At some of the bins: their number is part of the error.
    CHECK(factor.dot(mount.noise * factor) == Approx(mount.count).epsilon(0.02));
}

// Where the slope by columns is not that of the misfit itself, steps end beside its least value: by as many standard
// deviations as the two slopes differ. Half of one is a quarter of a unit of chi-squared. A mode at the end of the
// sweep has its largest response where the window falls.
TEST_CASE("Columns have the slope of the misfit, with a mode at the end of the sweep", "[linearised run]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    MountModel model = identify::testing::makeRandomDevice(random);
    model.bracket.front().frequency = 49.3;
    model.bracket.front().damping_ratio = 0.01;
    identify::testing::RunPlan plan;
    plan.duration = 24;
    plan.force = {2, 3, 4};
    const Recording recording = recordRun(model, plan, random);
    MountModel believed = model;
    believed.bracket.front().damping_ratio *= 1.02;
    const TestProblem problem({recording}, {}, believed);
    const TestView view = problem.view(problem.believedPoint());
    const BlockInformation& bracket = view.identification[indexOf(Block::bracket)];
    REQUIRE_FALSE(bracket.empty());
    const auto& table = problem.table();
    int tried = 0;
    for (std::size_t i = 0; i < table.size(); ++i) {
        const Unknown& row = table[i];
        const bool of_mode = (row.kind == UnknownKind::mode || row.kind == UnknownKind::shape) && row.first == 0;
        if (!of_mode && row.kind != UnknownKind::load && row.name != "body.mass") continue;
        const Eigen::Index column = i;
        const double A = bracket.A(column, column);
        if (!(A > 0)) continue;
        const double step = std::min(3 / std::sqrt(A), 1e-3 * row.reach);
        Eigen::VectorXd estimate = Eigen::VectorXd::Zero(problem.deviations().size());
        const auto misfitAt = [&](double value) {
            estimate[column] = value;
            return problem.misfit(problem.pointAt(estimate, {})).identification[indexOf(Block::bracket)].chi_squared;
        };
        const double slope = (misfitAt(step) - misfitAt(-step)) / (4 * step);
        CAPTURE(row.name);
        CHECK(slope / std::sqrt(A) ==
              Approx((bracket.b[column] - bracket.noise_slopes.row(column).sum()) / std::sqrt(A)).margin(0.5));
        ++tried;
    }
    CHECK(tried > 10);
}

// Nothing acts across the load, and nothing is wrong there: how the modes take part in that changes no misfit, so that
// the prior alone says what it is. The load of these recordings has no noise. Along it a hundredth shows.
TEST_CASE("What would act across the load changes no misfit", "[linearised run]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel model = identify::testing::makeRandomDevice(random);
    identify::testing::RunPlan plan;
    plan.duration = 4;
    plan.force = {20, 30, 120};
    const TestProblem problem({recordRun(model, plan, random)}, {}, model);
    constexpr std::size_t bracket = indexOf(Block::bracket);
    const auto calcSquares = [&](const Eigen::Vector3d& participation) {
        TestPoint point = problem.believedPoint();
        for (BracketMode& mode : point.state.model.bracket)
            mode.load_translation += mode.load_translation.norm() * participation;
        return problem.misfit(point).identification[bracket].chi_squared;
    };
    const Eigen::Vector3d along = plan.force.normalized(), across = along.unitOrthogonal();
    const double here = calcSquares(Eigen::Vector3d::Zero());
    CHECK(calcSquares(across) == Approx(here).epsilon(1e-6));
    CHECK(calcSquares(0.01 * along) > 1.01 * here);
}
