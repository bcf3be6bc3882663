// What a hypothesis sets far from the believed numbers: taken with it, and given back.
#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <memory>
#include <random>

#include "identify/updating/naming.hpp"
#include "identify/updating/test_problem.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/seed.hpp"

namespace wems::identify::updating {
namespace {

TestProblem makeProblem(std::mt19937_64& random) {
    const MountModel model = identify::testing::makeRandomDevice(random);
    identify::testing::RunPlan plan;
    plan.duration = 4;
    plan.force = Eigen::Vector3d(20, 40, 250);
    MountModel believed = model;
    believed.bracket.pop_back();
    return {{recordRun(model, plan, random)}, {}, believed, Numbers::exact};
}

std::vector<double> listBelieved(const TestProblem& problem) {
    std::vector<double> believed;
    for (const Unknown& row : problem.table()) believed.push_back(row.believed);
    return believed;
}

/// How far a mode's load point is from moving with the interface as the random devices' modes do, over its motion.
double calcLoadError(const BracketMode& mode) {
    const Eigen::Vector3d p(0.01, 0.02, 0);  // hidden_device.cpp
    return (mode.load_translation - mode.translation - mode.rotation.cross(p)).norm() / mode.load_translation.norm();
}

}  // namespace

TEST_CASE("A hypothesis that leaves the set takes with it what its adoption had set", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    TestProblem problem = makeProblem(random);
    problem.seekMissingMode(problem.believedPoint(), {});
    const std::vector<double> before = listBelieved(problem);
    int adopted = 0;
    for (int h = 0; h < static_cast<int>(problem.hypotheses().size()); ++h) {
        const Hypothesis pristine = problem.hypotheses()[h];
        if (pristine.tangent.empty()) continue;
        ++adopted;
        CAPTURE(describe(pristine));
        problem.adopt({h});
        CHECK(problem.hypotheses()[h].directions == pristine.tangent);
        for (const auto& [row, value] : pristine.start) CHECK(problem.table()[row].believed == value);
        TestPoint point = problem.pointAt(Eigen::VectorXd::Zero(problem.deviations().size()), {h});
        problem.release(point, h);
        for (const auto& [row, value] : pristine.start) {
            CHECK(point.values[row] == before[row]);
            CHECK(problem.table()[row].get(point.state) == before[row]);
        }
        problem.adopt({});
        CHECK(listBelieved(problem) == before);
        CHECK(problem.hypotheses()[h].directions == pristine.directions);
    }
    CHECK(adopted > 0);
}

TEST_CASE("Two clearances are a cause where each is beyond its tolerance, one factor where any number is",
          "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const TestProblem problem = makeProblem(random);
    int pairs = 0, factors = 0;
    for (const Hypothesis& hypothesis : problem.hypotheses()) {
        if (hypothesis.where.size() < 2 || !isToleranced(problem, hypothesis)) continue;
        CAPTURE(describe(hypothesis));
        const bool each = hypothesis.directions.size() > 1;
        ++(each ? pairs : factors);
        TestPoint point = problem.believedPoint();
        CHECK_FALSE(isBeyondTolerance(problem, hypothesis, point));
        const auto move = [&](int row) { point.values[row] += 2.1 * problem.table()[row].deviation; };
        move(hypothesis.reported.front());
        CHECK(isBeyondTolerance(problem, hypothesis, point) != each);
        for (std::size_t i = 1; i < hypothesis.reported.size(); ++i) move(hypothesis.reported[i]);
        CHECK(isBeyondTolerance(problem, hypothesis, point));
    }
    CHECK(pairs > 0);
    CHECK(factors > 0);
}

TEST_CASE("Numbers that one factor moves have their tolerances of what it makes of them", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    TestProblem problem = makeProblem(random);
    problem.assume(Numbers::within_tolerances);
    const auto own = [&](const HypothesisSet& set, const Eigen::VectorXd& estimate) {
        Eigen::VectorXd deviations = Eigen::VectorXd::Zero(estimate.size());
        for (const Direction& tolerance : problem.tolerances(set, estimate))
            deviations[tolerance.front().first] = tolerance.front().second;
        return deviations;
    };
    const Eigen::VectorXd plain = own({}, Eigen::VectorXd::Zero(problem.deviations().size()));
    CHECK(own({}, Eigen::VectorXd::Ones(plain.size())) == plain);
    const double factor = std::uniform_real_distribution<double>(0.2, 5)(random);
    CAPTURE(factor);
    int factors = 0;
    for (int h = 0; h < static_cast<int>(problem.hypotheses().size()); ++h) {
        const Hypothesis& hypothesis = problem.hypotheses()[h];
        CAPTURE(describe(hypothesis));
        const bool common = hypothesis.directions.size() == 1 && hypothesis.directions.front().size() > 1;
        Eigen::VectorXd moved = Eigen::VectorXd::Zero(plain.size()), expected = plain;
        for (const int row : hypothesis.reported) {
            const double believed = problem.table()[row].believed;
            moved[row] = (factor - 1) * believed;
            if (common && believed != 0) expected[row] *= factor;
        }
        factors += expected != plain;
        // What one of them is besides is its own.
        if (common && hypothesis.reported.size() > 2) moved[hypothesis.reported.back()] *= 7;
        CHECK(((own({h}, moved) - expected).array().abs() <= 1e-12 * expected.array()).all());
    }
    CHECK(factors > 10);
}

TEST_CASE("A connection that is elsewhere has the sensors there with it", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    TestProblem problem = makeProblem(random);
    CHECK(problem.deviations()[findUnknown(problem.table(), "mobile.2.position.y")] == 0);  // exact numbers
    problem.assume(Numbers::within_tolerances);
    const Eigen::VectorXd deviations = problem.deviations();
    int followed = 0;
    for (const Direction& tolerance : problem.tolerances({}, Eigen::VectorXd::Zero(deviations.size()))) {
        const Unknown& row = problem.table()[tolerance.front().first];
        CAPTURE(row.name);
        if (row.kind != UnknownKind::position) {
            CHECK(tolerance.size() == 1);
            continue;
        }
        REQUIRE(tolerance.size() == 3);
        const std::string end = row.name;  // `2.position.y`
        for (const auto& [column, deviation] : tolerance) {
            const std::string& name = problem.table()[column].name;
            CHECK(deviation == row.deviation);
            CHECK((name == end || name == "mobile." + end || name == "fixed." + end));
            if (name == end) continue;
            CHECK(deviations[column] == std::hypot(row.deviation, problem.table()[column].deviation));
            ++followed;
        }
    }
    CHECK(followed > 0);
}

TEST_CASE("A missing mode is sought once, and is one statement beside those of the modes that are there",
          "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    TestProblem problem = makeProblem(random);
    const auto isOfBracket = [](const Hypothesis& own) { return own.cause == "bracket_mode"; };
    const auto lacksNumbers = [&](const Hypothesis& own) { return isOfBracket(own) && own.reported.empty(); };
    const auto& all = problem.hypotheses();
    REQUIRE(std::count_if(all.begin(), all.end(), lacksNumbers) == 1);
    problem.seekMissingMode(problem.believedPoint(), {});
    REQUIRE(std::count_if(all.begin(), all.end(), lacksNumbers) == 0);
    std::vector<std::string> statements;
    for (int h = 0; h < static_cast<int>(all.size()); ++h)
        if (isOfBracket(all[h])) statements.push_back(signatureOf(problem, {h}));
    std::sort(statements.begin(), statements.end());
    CHECK(std::adjacent_find(statements.begin(), statements.end()) == statements.end());
}

TEST_CASE("The load moves a missing mode where its point is in the others, whatever is not known of its shape",
          "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    TestProblem problem = makeProblem(random);
    problem.seekMissingMode(problem.believedPoint(), {});
    const auto& all = problem.hypotheses();
    const int dormant = static_cast<int>(problem.believedPoint().state.model.bracket.size()) - 1;
    const auto found = std::find_if(all.begin(), all.end(), [&](const Hypothesis& own) {
        return !own.start.empty() && problem.table()[own.start.front().first].kind == UnknownKind::mode &&
               problem.table()[own.start.front().first].first == dormant;
    });
    REQUIRE(found != all.end());
    TestState state = problem.believedPoint().state;
    for (const auto& [row, value] : found->start) problem.table()[row].set(state, value);
    CHECK(calcLoadError(state.model.bracket.back()) < 1e-9);
    int shapes = 0;
    for (const Direction& direction : found->tangent) {
        TestState moved = state;
        for (const auto& [row, weight] : direction) {
            const Unknown& unknown = problem.table()[row];
            unknown.set(moved, unknown.get(moved) + weight);
        }
        const BracketMode &before = state.model.bracket.back(), &after = moved.model.bracket.back();
        if (after.translation != before.translation || after.rotation != before.rotation) ++shapes;
        CHECK(calcLoadError(after) < 1e-9);
    }
    CHECK(shapes == 6);
}

TEST_CASE("A stop is sought from as near as its probe, and what a set does not move is as believed", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const TestProblem problem = makeProblem(random);
    int probed = 0;
    for (int h = 0; h < static_cast<int>(problem.hypotheses().size()); ++h) {
        const Hypothesis& hypothesis = problem.hypotheses()[h];
        const auto far = problem.goToProbes(problem.believedPoint(), {h});
        const bool sought = hypothesis.start.empty() && !hypothesis.moves.empty();
        CHECK(far.has_value() == sought);
        if (!far) continue;
        ++probed;
        CAPTURE(describe(hypothesis));
        const int row = hypothesis.moves.front().second;
        CHECK(far->values[row] != problem.table()[row].believed);
        CHECK(problem.reduce(*far, {}).values == problem.believedPoint().values);
    }
    CHECK(probed > 0);
}

TEST_CASE("Of numbers that one factor moves a set states one factor, the nearest", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const TestProblem problem = makeProblem(random);
    const Eigen::Index count = problem.deviations().size();
    std::uniform_real_distribution<double> even(0.5, 1.5);
    int common = 0;
    for (int h = 0; h < static_cast<int>(problem.hypotheses().size()); ++h) {
        const Hypothesis& hypothesis = problem.hypotheses()[h];
        if (!hypothesis.tangent.empty() || hypothesis.directions.size() != 1) continue;
        const Direction& direction = hypothesis.directions.front();
        const auto isOfTable = [&](const auto& part) {
            return static_cast<std::size_t>(part.first) < problem.table().size();
        };
        if (direction.size() < 2 || !std::all_of(direction.begin(), direction.end(), isOfTable)) continue;
        CAPTURE(describe(hypothesis));
        ++common;
        const double factor = 0.05 * even(random);
        Eigen::VectorXd on = Eigen::VectorXd::Zero(count), off = on;
        for (const auto& [column, weight] : direction) {
            on[column] = factor * weight;
            off[column] = factor * even(random) * weight;
        }
        const auto reduce = [&](const Eigen::VectorXd& estimate) {
            return problem.estimateOf(problem.reduce(problem.pointAt(estimate, {h}), {h}));
        };
        const Eigen::VectorXd reached = problem.estimateOf(problem.pointAt(on, {h}));
        CHECK((reduce(on) - reached).cwiseAbs().maxCoeff() <= 1e-9 * reached.cwiseAbs().maxCoeff());
        const Eigen::VectorXd nearest = reduce(off);
        double least = std::numeric_limits<double>::infinity(), most = -least;
        for (const auto& [column, weight] : direction) {
            least = std::min(least, nearest[column] / weight);
            most = std::max(most, nearest[column] / weight);
        }
        CHECK(most - least <= 1e-9 * std::abs(factor));
        CHECK(least >= 0.5 * factor);
        CHECK(most <= 1.5 * factor);
    }
    CHECK(common > 10);
}

TEST_CASE("A copy of a problem outlives it, and what is adopted there stays there", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    auto problem = std::make_unique<TestProblem>(makeProblem(random));
    problem->seekMissingMode(problem->believedPoint(), {});
    TestProblem copy = *problem;
    CHECK(&copy.runs() == &problem->runs());
    const std::vector<double> before = listBelieved(*problem);
    const auto& all = problem->hypotheses();
    const auto sought = std::find_if(all.begin(), all.end(), [&](const Hypothesis& own) {
        return std::any_of(own.start.begin(), own.start.end(), [&](const auto& number) {
            return before[number.first] != number.second && !own.tangent.empty();
        });
    });
    REQUIRE(sought != all.end());
    copy.adopt({static_cast<int>(sought - all.begin())});
    copy.assume(Numbers::within_tolerances);
    CHECK(listBelieved(copy) != before);
    CHECK(listBelieved(*problem) == before);
    CHECK(problem->numbers() == Numbers::exact);
    const Information own = problem->view(problem->believedPoint(), HypothesisSet{}).identification;
    copy = *problem;
    problem.reset();
    const Information others = copy.view(copy.believedPoint(), HypothesisSet{}).identification;
    for (std::size_t k = 0; k < kBlocks; ++k) CHECK(others[k].chi_squared == own[k].chi_squared);
}

}  // namespace wems::identify::updating
