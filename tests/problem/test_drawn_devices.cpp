// Devices, set-ups and sensors as they are drawn at random: whatever is recorded, the equations can be formed.
#include <catch2/catch.hpp>
#include <string>

#include "identify/problem/lineariser.hpp"
#include "identify/updating/test_problem.hpp"
#include "tests/hidden/hidden_recording.hpp"
#include "tests/hidden/random_case.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;
using namespace wems::identify::updating;

namespace {

TestProblem drawProblem(const std::string& set_up, unsigned seed) {
    hidden::Random random(seed);
    hidden::CaseOptions options;
    options.level = std::uniform_int_distribution<int>(0, 2)(random);
    options.set_up_kind = set_up;
    const auto hidden = hidden::drawCase(options, random);
    return {{hidden::recordRun(hidden, 0, seed), hidden::recordRun(hidden, 1, seed)}, {}, hidden.base};
}

/// Of a column: they are kept in single precision, and forces of a stiff device nearly cancel.
constexpr double kRounding = 1e-4;

/// A number to which forces or moments are proportional, all others as they are.
bool isOfForce(const Unknown& number) {
    const bool in_newtons = number.unit.rfind("N", 0) == 0 || number.unit.rfind("kg", 0) == 0;
    return in_newtons || number.name == "load.gain";
}

}  // namespace

TEST_CASE("Whatever is recorded, every number has a column") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    const TestProblem problem = drawProblem(GENERATE("bracket", "base", "axis"), seed);
    const TestView view = problem.view(problem.believedPoint(), {});
    for (const BlockInformation& block : view.identification) {
        CHECK(block.A.allFinite());
        CHECK(block.b.allFinite());
    }
    CHECK_FALSE(view.identification[indexOf(Block::mount)].empty());
}

// The mount's equation is y(θ) = Σ θ_i ∂y/∂θ_i over masses, stiffnesses, damping and load: whatever moves, columns and
// residual are of one wrench.
TEST_CASE("What the equation leaves is what all its forces make of it") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    const TestProblem problem = drawProblem(GENERATE("bracket", "base", "axis"), seed);
    const TestPoint point = problem.believedPoint();
    const UnknownTable& table = problem.table();
    for (const LinearisedRun& run : problem.view(point).runs) {
        const BlockInformation& mount = run.information[indexOf(Block::mount)];
        Eigen::VectorXd forces = Eigen::VectorXd::Zero(mount.b.size());
        for (std::size_t i = 0; i < table.size(); ++i)
            if (isOfForce(table[i])) forces[static_cast<Eigen::Index>(i)] = point.values[static_cast<Eigen::Index>(i)];
        const Eigen::VectorXd apart = mount.A * forces - mount.b;
        const Eigen::VectorXd size = (mount.chi_squared * mount.A.diagonal()).cwiseSqrt();
        Eigen::Index worst = 0;
        const double largest = (size.array() > 0).select(apart.cwiseQuotient(size), 0.0).cwiseAbs().maxCoeff(&worst);
        INFO("worst along " << (worst < static_cast<Eigen::Index>(table.size()) ? table[worst].name : "a probe"));
        CHECK(largest < kRounding);
    }
}

// Mass-normalised shapes go with the root of the modal mass: with forces, load and modal masses all larger by one
// factor the bracket moves as before.
TEST_CASE("A bracket as much heavier as its forces are larger moves alike") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    const TestProblem problem = drawProblem("bracket", seed);
    const TestState& state = problem.believedPoint().state;
    const TestMisfit misfit = problem.misfit(problem.believedPoint());
    for (const auto& at : misfit.equations.at) {
        if (!at->hasBracket()) continue;
        at->prepareColumns();
        constexpr double kStep = 1e-3;
        MobileBody lighter = state.model.body, heavier = lighter;
        for (const auto& [body, factor] : {std::pair{&lighter, 1 - kStep}, std::pair{&heavier, 1 + kStep}}) {
            body->mass *= factor;
            body->inertia *= factor;
            body->spin *= factor;
        }
        Eigen::MatrixXcd mount, body, load;
        at->calcBodyColumn(lighter, heavier, 2 * kStep, mount, body);
        at->calcLoadColumn(at->calcLoadOf(3), mount, load);
        const Eigen::MatrixXcd forces = at->whiten({}, load.size() > 0 ? Eigen::MatrixXcd(body + load) : body);
        Eigen::MatrixXcd shapes = Eigen::MatrixXcd::Zero(6, forces.cols());
        double whole = forces.squaredNorm();
        for (const Unknown& row : problem.table()) {
            if (row.kind != UnknownKind::shape) continue;
            const Eigen::MatrixXcd column = -0.5 * row.get(state) * at->calcShapeColumn(row.first, row.second);
            whole += column.squaredNorm();
            shapes += column;
        }
        CHECK((forces.bottomRows(6) + shapes).norm() < kRounding * std::sqrt(whole));
    }
}
