#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/solve/evidence.hpp"
#include "tests/seed.hpp"

using namespace wems::identify;

namespace {

/// r = r₀ + J ε with white noise of unit variance in r₀.
struct Problem {
    Eigen::MatrixXd J;
    Eigen::VectorXd r;
    std::vector<Direction> tolerances;
    std::vector<Hypothesis> hypotheses;

    BlockInformation information() const {
        BlockInformation result;
        result.A = J.transpose() * J;
        result.b = J.transpose() * r;
        result.chi_squared = r.squaredNorm();
        result.count = static_cast<double>(r.size());
        return result;
    }
    /// What the prior and a set know.
    std::vector<Direction> collect(const HypothesisSet& set) const {
        std::vector<Direction> directions = tolerances;
        for (const int h : set)
            directions.insert(directions.end(), hypotheses[h].directions.begin(), hypotheses[h].directions.end());
        return directions;
    }
    /// Prior covariance of the unknowns under a set.
    Eigen::MatrixXd prior(const HypothesisSet& set) const {
        Eigen::MatrixXd C = Eigen::MatrixXd::Zero(J.cols(), J.cols());
        for (const Direction& direction : collect(set)) {
            Eigen::VectorXd along = Eigen::VectorXd::Zero(C.rows());
            for (const auto& [column, weight] : direction) along[column] += weight;
            C += along * along.transpose();
        }
        return C;
    }
    /// log N(r; 0, 1 + J C Jᵀ) in the space of the data, beside its constant, and the log odds.
    double bruteForce(const HypothesisSet& set) const {
        const Eigen::MatrixXd S = Eigen::MatrixXd::Identity(J.rows(), J.rows()) + J * prior(set) * J.transpose();
        const Eigen::LLT<Eigen::MatrixXd> factor(S);
        double odds = 0;
        for (const int h : set) odds += hypotheses[h].log_prior;
        return odds - 0.5 * r.dot(factor.solve(r)) - factor.matrixLLT().diagonal().array().log().sum();
    }
};

Hypothesis makeHypothesis(const std::string& cause, const std::string& place, std::vector<Direction> directions) {
    Hypothesis hypothesis;
    hypothesis.cause = cause;
    hypothesis.where = {place};
    hypothesis.directions = std::move(directions);
    hypothesis.log_prior = -2.5;
    return hypothesis;
}

Problem draw(unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const auto fill = [&](auto& values) {
        for (Eigen::Index i = 0; i < values.size(); ++i) values.data()[i] = normal(random);
    };
    Problem problem;
    problem.J.resize(60, 8);
    problem.r.resize(60);
    fill(problem.J);
    fill(problem.r);
    Eigen::VectorXd deviation(8);
    deviation << 0.1, 0.2, 0.05, 0, 0, 0.3, 0, 0.1;
    problem.tolerances = makeTolerances(deviation);
    problem.tolerances[1].emplace_back(7, -0.25);  // which another number follows
    problem.r += 1.5 * problem.J.col(3) - 0.8 * problem.J.col(0);
    problem.hypotheses = {makeHypothesis("a", "1", {{{0, 2.0}}}), makeHypothesis("b", "1", {{{3, 1.0}}}),
                          makeHypothesis("c", "2", {{{4, 1.0}}, {{6, 0.5}}}),
                          makeHypothesis("d", "3", {{{0, 1.0}, {1, 1.0}, {2, 1.0}}}),
                          makeHypothesis("a", "1", {{{1, 3.0}}})};
    return problem;
}

}  // namespace

TEST_CASE("Evidence of a set is the density of the data", "[evidence]") {
    const unsigned seed = wems::test::drawSeed();
    CAPTURE(seed);
    const Problem problem = draw(seed);
    const Evidence evidence(problem.information(), problem.tolerances, problem.hypotheses);
    const double constant = problem.bruteForce({}) - evidence.calcLogEvidence({});
    for (const HypothesisSet& set : {HypothesisSet{0}, {1}, {2}, {3}, {0, 1}, {1, 2, 3}}) {
        CHECK(evidence.calcLogEvidence(set) + constant == Approx(problem.bruteForce(set)).epsilon(1e-9));
        // Kalman's form of the posterior, in the space of the data.
        const Eigen::MatrixXd C = problem.prior(set);
        const Eigen::MatrixXd S = Eigen::MatrixXd::Identity(60, 60) + problem.J * C * problem.J.transpose();
        const Eigen::MatrixXd gain = C * problem.J.transpose() * S.inverse();
        const Posterior posterior = evidence.calcPosterior(set);
        CHECK((posterior.mean + gain * problem.r).norm() < 1e-8);
        CHECK((posterior.covariance - (C - gain * problem.J * C)).norm() < 1e-8);
        CHECK((evidence.solve(set).mean - posterior.mean).norm() < 1e-8);
        const SetSolution solution = evidence.solve(set);
        CHECK(solution.occam - 0.5 * (solution.prior_square + evidence.calcChange(solution.mean)) ==
              Approx(evidence.calcLogEvidence(set)).margin(1e-8));
    }
}

TEST_CASE("Extensions of a set are the evidence of the larger set", "[evidence]") {
    const unsigned seed = wems::test::drawSeed();
    CAPTURE(seed);
    const Problem problem = draw(seed);
    const Evidence evidence(problem.information(), problem.tolerances, problem.hypotheses);
    const auto extended = evidence.calcExtensions({1});
    CHECK(extended[0] == Approx(evidence.calcLogEvidence({0, 1})));
    CHECK(extended[2] == Approx(evidence.calcLogEvidence({1, 2})));
    CHECK(extended[3] == Approx(evidence.calcLogEvidence({1, 3})));
    CHECK_FALSE(std::isfinite(extended[1]));
    // The same statement of the same place does not stand beside itself.
    CHECK_FALSE(std::isfinite(evidence.calcExtensions({0})[4]));
}

TEST_CASE("A damped step is the posterior of a prior drawn to the present point", "[evidence]") {
    const unsigned seed = wems::test::drawSeed();
    CAPTURE(seed);
    const Problem problem = draw(seed);
    const Evidence evidence(problem.information(), problem.tolerances, problem.hypotheses);
    std::mt19937 random(seed + 1);
    std::normal_distribution<double> normal;
    for (const HypothesisSet& set : {HypothesisSet{}, {0}, {1, 2}, {0, 3}}) {
        const Eigen::MatrixXd C = problem.prior(set);
        Eigen::VectorXd slope(C.rows());
        for (double& value : slope) value = normal(random);
        const Eigen::VectorXd present = C * slope;
        for (const double damping : {0.0, 1.0, 30.0, 1e4}) {
            CAPTURE(set, damping);
            // Two Gaussians, N(0, C) and N(present, C / damping), make one; its posterior in the space of the data.
            const Eigen::VectorXd mean = damping / (1 + damping) * present;
            const Eigen::MatrixXd covariance = C / (1 + damping);
            const Eigen::MatrixXd S =
                Eigen::MatrixXd::Identity(60, 60) + problem.J * covariance * problem.J.transpose();
            const Eigen::VectorXd expected =
                mean - covariance * problem.J.transpose() * S.llt().solve(problem.r + problem.J * mean);
            CHECK((evidence.solveNear(set, slope, damping) - expected).norm() < 1e-9 * (1 + expected.norm()));
        }
        CHECK((evidence.solveNear(set, slope, 0) - evidence.solve(set).mean).norm() < 1e-12);
    }
}

TEST_CASE("The slope of a prior is the inverse of its covariance, where it has one", "[evidence]") {
    const unsigned seed = wems::test::drawSeed();
    CAPTURE(seed);
    const Problem problem = draw(seed);
    std::mt19937 random(seed + 2);
    std::normal_distribution<double> normal;
    for (const HypothesisSet& set : {HypothesisSet{}, {0}, {1}, {1, 2}, {0, 3}}) {
        CAPTURE(set);
        const std::vector<Direction> directions = problem.collect(set);
        const Eigen::MatrixXd C = problem.prior(set);
        // Where the set leads.
        Eigen::VectorXd z(8);
        for (double& value : z) value = normal(random);
        const Eigen::VectorXd estimate = C * z, slope = calcPriorSlope(directions, estimate);
        CHECK((C * slope - estimate).norm() < 1e-12 * estimate.norm());
        CHECK(estimate.dot(slope) ==
              Approx(estimate.dot(C.completeOrthogonalDecomposition().solve(estimate))).epsilon(1e-9));
    }
}

TEST_CASE("The search finds the set of highest evidence", "[evidence]") {
    const unsigned seed = wems::test::drawSeed();
    CAPTURE(seed);
    const Problem problem = draw(seed);
    const Evidence evidence(problem.information(), problem.tolerances, problem.hypotheses);
    double best = evidence.calcLogEvidence({});
    for (int a = 0; a < 5; ++a) {
        best = std::max(best, evidence.calcLogEvidence({a}));
        for (int b = a + 1; b < 5; ++b)
            if (!(a == 0 && b == 4)) best = std::max(best, evidence.calcLogEvidence({a, b}));
    }
    CHECK(evidence.search({}, 5, 2).front().log_evidence == Approx(best));
}

TEST_CASE("An information shifted to the believed values predicts the same misfit", "[evidence]") {
    const Problem problem = draw(5);
    const Eigen::VectorXd offset = Eigen::VectorXd::LinSpaced(8, -0.3, 0.4);
    // About the state, the residual is that of the believed values plus J · state.
    Problem about = problem;
    about.r = problem.r - problem.J * offset;
    const BlockInformation shifted = shiftToBelieved(about.information(), offset);
    const Eigen::VectorXd estimate = Eigen::VectorXd::LinSpaced(8, 0.2, -0.1);
    CHECK(calcBlockMisfit(shifted, estimate) ==
          Approx((problem.r + problem.J * estimate).squaredNorm() / 60).epsilon(1e-10));
}

// A stiffness of 1e8 N/m and an offset that is known: rounding of the one, 1e-16 of its square, was the other's
// variance.
TEST_CASE("The root of a covariance keeps units of very different size apart") {
    const unsigned seed = wems::test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    constexpr int size = 40;
    Eigen::VectorXd unit(size);
    for (int i = 0; i < size; ++i) unit[i] = i % 4 == 0 ? 0 : std::pow(10, -8 + 16 * (i % 7) / 6.0);
    Eigen::MatrixXd factor(size, size / 2);  // singular
    for (double& value : factor.reshaped()) value = normal(random);
    factor = unit.asDiagonal() * factor;
    const Eigen::MatrixXd covariance = factor * factor.transpose(), root = calcCovarianceRoot(covariance);
    for (int i = 0; i < size; ++i) {
        CAPTURE(i);
        if (unit[i] == 0) CHECK(root.row(i).cwiseAbs().maxCoeff() == 0);
        for (int j = 0; j < size; ++j)
            CHECK(root.row(i).dot(root.row(j)) == Approx(covariance(i, j)).margin(1e-12 * size * unit[i] * unit[j]));
    }
}
