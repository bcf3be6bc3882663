// Truncated SVD against closed forms.
#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <random>

#include "identify/paper/truncated_svd.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

Eigen::MatrixXd drawMatrix(std::mt19937& random, Eigen::Index rows, Eigen::Index columns) {
    std::normal_distribution<double> normal;
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

TEST_CASE("With all singular values kept the solution is that of the normal equations") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    const Eigen::MatrixXd A = drawMatrix(random, 60, 5);
    const Eigen::VectorXd b = drawMatrix(random, 60, 1);
    const TruncatedSolution solution = solveTruncated(A, b, 99);
    const Eigen::VectorXd expected = (A.transpose() * A).ldlt().solve(A.transpose() * b);
    CHECK((solution.x - expected).norm() < 1e-9 * expected.norm());
    CHECK(solution.rank == 5);
    CHECK(solution.singular_percent.sum() == Approx(100));
    CHECK(solution.residual_fraction == Approx((b - A * expected).norm() / b.norm()));
}

TEST_CASE("Dependent columns: the truncated solution is the truth without its part along the dependence") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    Eigen::MatrixXd A(200, 4);  // z1 + z2 = z3 + z4, as the ends of a rigid cross have it
    A.leftCols<3>() = drawMatrix(random, 200, 3);
    A.col(3) = A.col(0) + A.col(1) - A.col(2);
    const Eigen::Vector4d truth(1, 1, 0.8, 1), dependence(0.5, 0.5, -0.5, -0.5);
    const TruncatedSolution solution = solveTruncated(A, A * truth, 0);
    CHECK(solution.rank == 3);
    const Eigen::Vector4d expected = truth - dependence * dependence.dot(truth);
    CHECK((solution.x - expected).norm() < 1e-9);
    CHECK(expected.isApprox(Eigen::Vector4d(0.95, 0.95, 0.85, 1.05)));
}

TEST_CASE("A term's confidence factor is the growth of the residual variance without it") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    constexpr int rows = 40000;
    const Eigen::MatrixXd A = drawMatrix(random, rows, 2);
    const Eigen::VectorXd b = 3 * A.col(0) + drawMatrix(random, rows, 1);  // the second column explains nothing
    const TruncatedSolution solution = solveTruncated(A, b, 0);
    CHECK(solution.confidence(0) == Approx(10).epsilon(0.1));  // 1 + 3²
    CHECK(solution.confidence_refitted(0) == Approx(10).epsilon(0.1));
    CHECK(solution.confidence(1) == Approx(1).margin(2e-3));
    CHECK(solution.confidence_refitted(1) >= 1);
}

TEST_CASE("The numerical rank ends at the first wide gap") {
    CHECK(findNumericalRank(Eigen::Vector4d(55.6, 43.3, 0.6, 0.5)) == 2);
    CHECK(findNumericalRank(Eigen::Vector4d(60, 40, 1e-7, 1e-14)) == 2);
    CHECK(findNumericalRank(Eigen::Vector3d(50, 30, 20)) == 3);
    CHECK(findNumericalRank(Eigen::Vector2d(1, 0)) == 1);
}

}  // namespace
}  // namespace wems::identify
