#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/component/block_regression.hpp"

namespace wems::identify {
namespace {

/// y = 3 x + 1 with residuals that repeat over some 40 samples; the regressor repeats likewise, which is what makes
/// the usual formula wrong.
struct Draw {
    Eigen::MatrixXd X;
    Eigen::VectorXd y;
};

Draw drawCorrelated(std::mt19937& generator, Eigen::Index n) {
    std::normal_distribution<double> normal;
    Draw draw{Eigen::MatrixXd::Ones(n, 2), Eigen::VectorXd(n)};
    double x = normal(generator), r = normal(generator);
    for (Eigen::Index i = 0; i < n; ++i) {
        x = 0.95 * x + std::sqrt(1 - 0.95 * 0.95) * normal(generator);
        r = 0.95 * r + std::sqrt(1 - 0.95 * 0.95) * normal(generator);
        draw.X(i, 0) = x;
        draw.y[i] = 3 * x + 1 + r;
    }
    return draw;
}

}  // namespace

TEST_CASE("Intervals of correlated residuals hold the truth about 95 times in 100") {
    const unsigned seed = 20240611;
    CAPTURE(seed);
    std::mt19937 generator(seed);
    int held = 0, held_white = 0;
    constexpr int draws = 300;
    for (int i = 0; i < draws; ++i) {
        const auto draw = drawCorrelated(generator, 3000);
        const auto e = solveBlocks(draw.X, draw.y, {0});
        held += std::abs(e.value[0] - 3) <= e.calcHalfWidth(0) ? 1 : 0;
        // The textbook formula for independent residuals, for comparison.
        const double s2 = e.residual.squaredNorm() / 2998;
        const double white = 1.96 * std::sqrt(s2 * (draw.X.transpose() * draw.X).inverse()(0, 0));
        held_white += std::abs(e.value[0] - 3) <= white ? 1 : 0;
    }
    CAPTURE(held, held_white);
    // At 95 % fewer than 270 of 300 come by chance once in 8000 such sets of draws; at 85 % in 99 of 100. The textbook
    // formula is 4.4 times too narrow, √((1 + ρ²)/(1 − ρ²)) with ρ = 0.95, and holds a third: 200 are out of the
    // question.
    CHECK(held >= 270);
    CHECK(held_white < 200);
}

TEST_CASE("A column that the data cannot tell from another gets an infinite interval") {
    const Eigen::Index n = 500;
    Eigen::MatrixXd X(n, 3);
    Eigen::VectorXd y(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const double t = 0.01 * static_cast<double>(i);
        X.row(i) << std::sin(t), 2 * std::sin(t), std::cos(3 * t);
        y[i] = std::sin(t) + 5 * std::cos(3 * t) + 0.01 * std::sin(97 * t);
    }
    const auto e = solveBlocks(X, y, {0});
    CHECK(std::isinf(e.calcHalfWidth(0)));
    CHECK(std::isinf(e.calcHalfWidth(1)));
    CHECK(e.value[2] == Approx(5).epsilon(0.01));
    CHECK(e.calcHalfWidth(2) < 0.1);
}

TEST_CASE("Hinges are found exactly where there is no noise") {
    const Eigen::Index n = 2000;
    HingeProblem problem;
    problem.base.resize(n, 2);
    problem.q.resize(n);
    problem.y.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const double q = 4e-3 * std::sin(0.0137 * static_cast<double>(i));
        problem.q[i] = q;
        problem.base.row(i) << 1, q;
        problem.y[i] = 7 + 1e5 * q + 4e5 * std::max(q - 1.7e-3, 0.0) + 9e5 * std::min(q + 2.9e-3, 0.0);
    }
    problem.start = {{1, 0}, {-1, 0}};
    problem.run_starts = {0};
    const auto fit = fitHinges(problem, false);
    CHECK(fit.hinges[0].position == Approx(1.7e-3).epsilon(1e-5));
    CHECK(fit.hinges[1].position == Approx(-2.9e-3).epsilon(1e-5));
    CHECK(fit.estimates.value[1] == Approx(1e5).epsilon(1e-5));
    CHECK(fit.estimates.value[2] == Approx(4e5).epsilon(1e-4));
    CHECK(fit.estimates.value[3] == Approx(9e5).epsilon(1e-4));
}

}  // namespace wems::identify
