#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <random>

#include "identify/problem/information.hpp"
#include "tests/seed.hpp"

using namespace wems::identify;

namespace {

BlockInformation makeBlock(const Eigen::MatrixXd& J, const Eigen::VectorXd& r) {
    BlockInformation block;
    block.A = J.transpose() * J;
    block.b = J.transpose() * r;
    block.noise_slopes = Eigen::MatrixXd::Zero(J.cols(), 0);
    block.chi_squared = r.squaredNorm();
    block.count = static_cast<double>(r.size());
    return block;
}

Eigen::MatrixXd drawMatrix(Eigen::Index rows, Eigen::Index columns, std::mt19937& random) {
    std::normal_distribution<double> normal;
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

}  // namespace

TEST_CASE("Runs add", "[information]") {
    std::mt19937 random(1);
    const Eigen::MatrixXd J = drawMatrix(40, 5, random);
    const Eigen::VectorXd r = drawMatrix(40, 1, random);
    BlockInformation sum = makeBlock(J.topRows(15), r.head(15));
    sum.add(makeBlock(J.bottomRows(25), r.tail(25)));
    const BlockInformation whole = makeBlock(J, r);
    CHECK((sum.A - whole.A).norm() < 1e-12);
    CHECK((sum.b - whole.b).norm() < 1e-12);
    CHECK(sum.chi_squared == Approx(whole.chi_squared));
    CHECK(sum.count == 40);
}

TEST_CASE("Blocks weigh by their scale, and what is not seen stays unknown", "[information]") {
    std::mt19937 random(2);
    Eigen::MatrixXd J = drawMatrix(40, 5, random);
    J.col(3).setZero();
    const Eigen::VectorXd r = drawMatrix(40, 1, random);
    Information all;
    all[0] = makeBlock(J, r);
    BlockScales scales;
    scales[0] = {4.0, 1.0};
    // A reach so wide that it says nothing.
    const BlockInformation sum = combine(all, scales, Eigen::VectorXd::Constant(5, 1e6));
    CHECK((sum.A - all[0].A / 4).norm() < 1e-9);
    CHECK((sum.b - all[0].b / 4).norm() < 1e-9);
    CHECK(sum.A(3, 3) == 0);
}

// Least squares whose gradient scatters by V beyond A has the sandwich (A⁻¹ (A + V) A⁻¹) as covariance (Huber 1967).
TEST_CASE("Bursts of noise widen by the sandwich", "[information]") {
    std::mt19937 random(3);
    const Eigen::MatrixXd J = drawMatrix(40, 4, random), root = drawMatrix(4, 4, random);
    const Eigen::VectorXd r = drawMatrix(40, 1, random);
    Information all;
    all[0] = makeBlock(J, r);
    all[0].scatter = 30 * root * root.transpose();
    const BlockInformation sum = combine(all, {}, Eigen::VectorXd::Constant(4, 1e7));
    const Eigen::MatrixXd inverse = all[0].A.inverse();
    CHECK((sum.A.inverse() - inverse * (all[0].A + all[0].scatter) * inverse).norm() < 1e-8);
    // The estimate is that of least squares.
    CHECK((sum.A.ldlt().solve(sum.b) - inverse * all[0].b).norm() < 1e-8);
}

TEST_CASE("Bursts are those of noise in a step, and of all that is left in a rank", "[information]") {
    Information all;
    all[0] = makeBlock(Eigen::MatrixXd::Constant(1, 1, 4), Eigen::VectorXd::Constant(1, 5));
    all[0].scatter = Eigen::MatrixXd::Constant(1, 1, 64);
    const auto calcInformation = [&](double scale, Growth growth) {
        BlockScales scales;
        scales[0].scale = scale;
        return combine(all, scales, Eigen::VectorXd::Constant(1, 1e7), growth).A(0, 0);
    };
    for (const Growth growth : {Growth::followed, Growth::doubted})
        CHECK(calcInformation(1, growth) == Approx(16. * 16 / (16 + 64)));
    CHECK(calcInformation(4, Growth::followed) == Approx(4. * 4 / (4 + 4)));  // A 16 / 4, V 64 / 16
    CHECK(calcInformation(4, Growth::doubted) == Approx(4. * 4 / (4 + 16)));  // V 64 / 4
}

// y = θ x with noise in x and y: least squares is drawn to zero by σ² N, which the slope takes off.
TEST_CASE("The noise slope takes the regressor's noise off", "[information]") {
    std::mt19937 random(4);
    std::normal_distribution<double> normal;
    const double theta = 2, sigma = 0.3;
    const int count = 200000;
    Eigen::VectorXd x(count), y(count);
    for (int i = 0; i < count; ++i) {
        const double truth = normal(random);
        x[i] = truth + sigma * normal(random);
        y[i] = theta * truth + sigma * normal(random);
    }
    // r = (θ x − y) / s about θ with s² = (1 + θ²) σ²; ∂r = x / s, and the noises of both share θ σ² / s².
    const double s = sigma * std::sqrt(1 + theta * theta);
    BlockInformation block = makeBlock(x / s, (theta * x - y) / s);
    block.noise_slopes = Eigen::MatrixXd::Constant(1, 1, count * theta * sigma * sigma / (s * s));
    block.noise_levels = Eigen::VectorXd::Ones(1);
    const double plain = -block.b[0] / block.A(0, 0);
    Information all;
    all[0] = block;
    BlockScales scales;
    scales[0].level = block.chi_squared / block.count;
    CHECK(scales[0].level == Approx(1).margin(0.02));
    const BlockInformation corrected = combine(all, scales, Eigen::VectorXd::Constant(1, 1e6));
    CHECK(std::abs(plain) > 0.1);
    CHECK(std::abs(corrected.b[0] / corrected.A(0, 0)) < 0.01);
}

// y = θ₁ x₁ + θ₂ x₂, both with the same signal and with noises of their own: only the sum of the two is known.
TEST_CASE("What the regressors' noise makes of a direction is no knowledge of it", "[information]") {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    const double sigma = 0.3;
    const int count = 200000;
    Eigen::MatrixXd x(count, 2);
    Eigen::VectorXd y(count);
    for (int i = 0; i < count; ++i) {
        const double truth = normal(random);
        for (int c = 0; c < 2; ++c) x(i, c) = truth + sigma * normal(random);
        y[i] = 2 * truth + sigma * normal(random);
    }
    // About θ = (1, 1): the residual's variance is (1 + 1 + 1) σ², each regressor's share of it σ².
    const double s = sigma * std::sqrt(3.0), own = count * sigma * sigma / (s * s);
    Information all;
    all[0] = makeBlock(x / s, (x.rowwise().sum() - y) / s);
    all[0].noise_slopes = Eigen::MatrixXd::Constant(2, 1, own);
    all[0].noise_levels = Eigen::VectorXd::Ones(1);
    const Eigen::Vector2d difference(std::sqrt(0.5), -std::sqrt(0.5)), sum(std::sqrt(0.5), std::sqrt(0.5));
    const Eigen::VectorXd reach = Eigen::VectorXd::Constant(2, 1e6);
    const auto precision = [&](const Eigen::Vector2d& along) { return along.dot(combine(all, {}, reach).A * along); };
    const double believed = precision(difference), known = precision(sum);
    CHECK(believed == Approx(own).epsilon(0.02));
    all[0].noise = own * Eigen::MatrixXd::Identity(2, 2);
    // Of squares of noise, whose sum scatters by √(2 / count), only the scatter squared is left.
    CHECK(precision(difference) < 1e-3 * believed);
    CHECK(precision(sum) == Approx(known).epsilon(0.15));
    CHECK(precision(sum) < known);
}

// One unknown by hand: 16 of information from b = 20 and a slope of 10, of which 30 % are open, 3² more in the scatter:
// A C⁻¹ A = 16²/(16 + 9), A C⁻¹ (b − s) = 16 · 10/25.
TEST_CASE("What the noise slope takes off is known to its level only", "[information]") {
    Information all;
    all[0].A = Eigen::MatrixXd::Constant(1, 1, 16);
    all[0].b = Eigen::VectorXd::Constant(1, 20);
    all[0].noise_slopes = Eigen::MatrixXd::Constant(1, 1, 10);
    all[0].noise_levels = Eigen::VectorXd::Ones(1);
    all[0].chi_squared = all[0].count = 100;
    const BlockInformation sum = combine(all, {}, Eigen::VectorXd::Constant(1, 1e9));
    CHECK(sum.A(0, 0) == Approx(10.24));
    CHECK(sum.b[0] == Approx(6.4));
    // Where growth is followed: of a slope that a wrong model made ten times what noise makes of it, a tenth counts, 16
    // + 3² becomes 16 + 0.3²; and what growth takes off the columns it takes off their scatter, 12 in place of 16.
    all[0].noise_levels[0] = 10;
    const auto follow = [&] { return combine(all, {}, Eigen::VectorXd::Constant(1, 1e9), Growth::followed).A(0, 0); };
    CHECK(follow() == Approx(256 / 16.09));
    all[0].growth = Eigen::MatrixXd::Constant(1, 1, 4);
    CHECK(follow() == Approx(144 / 12.09));
    CHECK(combine(all, {}, Eigen::VectorXd::Constant(1, 1e9)).A(0, 0) == Approx(10.24));
}

// r = r₀ + J θ of a wrong model, thousands of times the noise, whose covariance grows alike in all values: R = 1 + g·θ.
// Columns and product of R^{-½} r by finite differences.
TEST_CASE("Where the covariance grows with a wrong model, its columns are those of the whitened residual",
          "[information]") {
    const unsigned seed = wems::test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const auto draw = [&](Eigen::Index rows, Eigen::Index cols) {
        return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return normal(random); }));
    };
    const Eigen::MatrixXd J = 1e4 * draw(40, 3);
    const Eigen::VectorXd r = 1e4 * draw(40, 1) + J * draw(3, 1), g = 0.5 * draw(3, 1);
    const auto whiten = [&](const Eigen::Vector3d& theta) -> Eigen::VectorXd {
        return (r + J * theta) / std::sqrt(1 + g.dot(theta));
    };
    const double step = 1e-5;
    Eigen::MatrixXd columns(40, 3);
    for (int i = 0; i < 3; ++i) {
        const Eigen::Vector3d along = step * Eigen::Vector3d::Unit(i);
        columns.col(i) = (whiten(along) - whiten(-along)) / (2 * step);
    }
    BlockInformation block = makeBlock(J, r);
    block.noise_slopes = 0.5 * block.chi_squared * g;
    const Eigen::MatrixXd expected = columns.transpose() * columns, product = block.A - calcGrowth(block);
    CHECK((product - expected).norm() < 1e-6 * expected.norm());
    CHECK((block.b - block.noise_slopes - columns.transpose() * r).norm() < 1e-6 * block.b.norm());
    block.chi_squared = block.count;
    CHECK(calcGrowth(block).size() == 0);
}
