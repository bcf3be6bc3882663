#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <random>

#include "identify/motion/fourier.hpp"
#include "identify/motion/real_transform.hpp"
#include "tests/seed.hpp"

using wems::identify::Fourier;
using wems::identify::RealTransform;

namespace {

/// By the definition.
Eigen::VectorXcd sumUp(const Eigen::VectorXd& samples) {
    const Eigen::Index n = samples.size();
    Eigen::VectorXcd bins = Eigen::VectorXcd::Zero(n / 2 + 1);
    for (Eigen::Index k = 0; k < bins.size(); ++k)
        for (Eigen::Index i = 0; i < n; ++i)
            bins[k] += samples[i] * std::polar(1.0, -2 * M_PI * static_cast<double>(i * k) / static_cast<double>(n));
    return bins;
}

}  // namespace

TEST_CASE("RealTransform: the definition's sums, and back, for even and odd lengths") {
    const auto length = GENERATE(Eigen::Index{1}, Eigen::Index{2}, Eigen::Index{5}, Eigen::Index{12}, Eigen::Index{35});
    const auto seed = wems::test::drawSeed();
    CAPTURE(seed, length);
    std::mt19937_64 random(seed);
    const Eigen::VectorXd samples =
        Eigen::VectorXd::NullaryExpr(length, [&] { return std::uniform_real_distribution<>(-1, 1)(random); });
    const RealTransform transform(length);
    CHECK(transform.length() == length);
    const Eigen::VectorXcd bins = transform.forward(samples);
    REQUIRE(bins.size() == transform.binCount());
    // Round-off of sums of 35 terms of size 1.
    CHECK((bins - sumUp(samples)).norm() < 1e-13);
    CHECK((transform.inverse(bins) - samples).norm() < 1e-14);
}

TEST_CASE("RealTransform: fewer samples are continued by zeros; what is given stays as it was") {
    const Eigen::VectorXd samples = Eigen::VectorXd::LinSpaced(7, 1, 4);
    Eigen::VectorXd padded = Eigen::VectorXd::Zero(16);
    padded.head(7) = samples;
    const RealTransform transform(16);
    const Eigen::VectorXcd bins = transform.forward(samples);
    CHECK((bins - transform.forward(padded)).norm() == 0);
    transform.inverse(bins);
    CHECK((bins - transform.forward(samples)).norm() == 0);
}

TEST_CASE("Fourier: some bins of windowed rows are those of the products' spectra") {
    const auto seed = wems::test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const auto draw = [&] { return std::uniform_real_distribution<>(-1, 1)(random); };
    const Eigen::MatrixXd rows = Eigen::MatrixXd::NullaryExpr(3, 37, draw);
    const Eigen::VectorXd window = Eigen::VectorXd::NullaryExpr(37, draw);
    const Fourier fourier(37);
    const Eigen::MatrixXcd some = fourier.forward(rows, window, 4, 9);
    REQUIRE(some.cols() == 9);
    CHECK((some - fourier.forward(rows * window.asDiagonal()).middleCols(4, 9)).norm() < 1e-13);
}
