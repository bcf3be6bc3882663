#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/motion/noise_density.hpp"
#include "models/common/units.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

constexpr double kInterval = 1e-3;

Eigen::MatrixXd drawNoise(int channels, int samples, double deviation, std::mt19937& random) {
    std::normal_distribution<double> normal(0, deviation);
    return Eigen::MatrixXd::NullaryExpr(channels, samples, [&] { return normal(random); });
}

}  // namespace

TEST_CASE("The lower quartile of squared Gaussian values", "[noise density]") {
    std::mt19937 random(1);
    for (const int freedom : {1, 3, 12}) {
        std::chi_squared_distribution<double> square(freedom);
        std::vector<double> values(200001);
        for (double& value : values) value = square(random);
        std::sort(values.begin(), values.end());
        CHECK(calcQuartileRatio(freedom) ==
              Approx(values[values.size() / 4] / freedom).margin(freedom == 1 ? 0.03 : 0.01));
    }
}

TEST_CASE("White noise has its variance at every frequency, a passing sweep or not", "[noise density]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    const int samples = 30000;
    Eigen::MatrixXd residual = drawNoise(6, samples, 2e-6, random);
    // A gain error of the sweep's channels, ten times the noise, 5 to 50 Hz.
    const double rate = std::log(10.0) / (samples * kInterval);
    for (int k = 0; k < samples; ++k)
        residual.col(k).array() += 2e-5 * std::sin(kTwoPi * 5 * std::expm1(rate * k * kInterval) / rate);
    const NoiseDensity density(residual, 6, kInterval, 1.25, 0);
    for (const double f : {3.0, 8.0, 20.0, 45.0, 120.0, 400.0}) CHECK(density.at(f) == Approx(4e-12).epsilon(0.45));
    CHECK(density.variance() == Approx(4e-12).epsilon(0.1));
}

// A load is a sweep as a whole: sixty decibels above its noise, which no redundancy tells.
TEST_CASE("A sweep does not leak into the noise of the bands that it does not pass", "[noise density]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    const int samples = 50000;
    Eigen::MatrixXd load = drawNoise(3, samples, 1e-3, random);
    const double rate = std::log(10.0) / (samples * kInterval);
    for (int k = 0; k < samples; ++k)
        load.col(k).array() += std::sin(kTwoPi * 5 * std::expm1(rate * k * kInterval) / rate);
    const NoiseDensity density(load, 3, kInterval, 1.25, 0);
    // A band's own scatter is 12 %, and the quartile of all times is a higher one of those without the sweep: 25 %
    // more. With Hann's window the leakage alone is twice the noise at 20 Hz.
    for (const double f : {20.0, 45.0, 120.0, 400.0}) {
        CAPTURE(f);
        CHECK(density.at(f) > 0.6e-6);
        CHECK(density.at(f) < 1.9e-6);
    }
    CHECK(density.medianBetween(100, 300) == Approx(1e-6).epsilon(0.1));
    CHECK(density.medianBetween(300.2, 300.3) == density.at(300.3));
}

TEST_CASE("Noise that falls with frequency is followed", "[noise density]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    Eigen::MatrixXd residual = drawNoise(6, 40000, 1.0, random);
    // First-order low pass: variance density 1 / |1 − a exp(−iωh)|².
    const double a = 0.9;
    for (Eigen::Index k = 1; k < residual.cols(); ++k) residual.col(k) += a * residual.col(k - 1);
    const NoiseDensity density(residual, 6, kInterval, 1.25, 0);
    for (const double f : {5.0, 30.0, 100.0, 300.0}) {
        const double expected = 1 / (1 + a * a - 2 * a * std::cos(kTwoPi * f * kInterval));
        CHECK(density.at(f) == Approx(expected).epsilon(0.3));
    }
}

// Random walk that forgets within τ: of density 2 σ² τ / interval at rest, falling from 1/(2πτ) on.
TEST_CASE("Noise is resolved below what a stretch resolves", "[noise density]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const int samples = 40000, channels = 12, draws = 20;
    const double tau = 2.0, keep = std::exp(-kInterval / tau), deviation = 3e-6;
    const auto exact = [&](double f) {
        const double x = kTwoPi * f * kInterval;
        return deviation * deviation * (1 - keep * keep) / (1 - 2 * keep * std::cos(x) + keep * keep);
    };
    // The mean of a run, whose line is a fortieth of a hertz wide; what eight stretches do not resolve; what they do.
    const std::vector<std::vector<double>> bands{{0.0}, {0.075, 0.1, 0.125, 0.15, 0.175}, {1.0}, {5.0}};
    std::vector<double> sums(bands.size(), 0.0), expected(bands.size(), 0.0);
    for (int draw = 0; draw < draws; ++draw) {
        Eigen::MatrixXd residual(channels, samples);
        Eigen::VectorXd state = Eigen::VectorXd::NullaryExpr(channels, [&] { return deviation * normal(random); });
        for (int k = 0; k < samples; ++k) {
            residual.col(k) = state;
            state = keep * state + deviation * std::sqrt(1 - keep * keep) *
                                       Eigen::VectorXd::NullaryExpr(channels, [&] { return normal(random); });
        }
        const NoiseDensity density = estimateNoiseDensity(residual, channels, 0, kInterval);
        for (std::size_t i = 0; i < bands.size(); ++i)
            for (const double f : bands[i]) {
                sums[i] += density.at(f) / draws;
                expected[i] += exact(f) / draws;
            }
    }
    // Of the mean over twenty draws of six channels a tenth is chance.
    for (std::size_t i = 0; i < bands.size(); ++i) {
        CAPTURE(bands[i].front());
        CHECK(sums[i] == Approx(expected[i]).epsilon(0.35));
    }
}
