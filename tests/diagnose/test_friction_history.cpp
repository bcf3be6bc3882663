#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <random>

#include "identify/problem/band_limited_force.hpp"
#include "identify/problem/velocity_noise.hpp"
#include "models/common/units.hpp"
#include "tests/seed.hpp"

using namespace wems::identify;
using wems::kPi;
using wems::kTwoPi;

namespace {

/// Fourier coefficient of a history at a frequency.
std::complex<double> calcCoefficient(const Eigen::VectorXd& history, double interval, double frequency) {
    std::complex<double> sum = 0;
    for (Eigen::Index k = 0; k < history.size(); ++k)
        sum += history[k] * std::polar(2.0 / static_cast<double>(history.size()),
                                       -kTwoPi * frequency * interval * static_cast<double>(k));
    return sum;
}

}  // namespace

TEST_CASE("Friction at the samples has the harmonics that it has between them", "[diagnose]") {
    const auto seed = wems::test::drawSeed();
    INFO("seed " << seed);
    std::mt19937_64 random(seed);
    // One second of whole periods of whole samples, so that a reversal falls at the same place between samples in each.
    constexpr int kCycles[] = {5, 8, 10, 20, 25};
    const int cycles = kCycles[std::uniform_int_distribution<int>(0, 4)(random)];
    const double phase = std::uniform_real_distribution<double>(0, kTwoPi)(random);
    constexpr double kTransition = 1e-3, kAmplitude = 0.1, kMean = 0.02;
    const auto velocity = [&](int count) {
        return Eigen::VectorXd(
            kMean +
            kAmplitude * (kTwoPi * cycles / count * Eigen::ArrayXd::LinSpaced(count, 0, count - 1) + phase).sin());
    };
    constexpr int kCoarse = 1000, kFine = 200000;
    const Eigen::VectorXd fine = (velocity(kFine).array() / kTransition).tanh();
    const Eigen::VectorXd coarse = calcSlidingDirection(velocity(kCoarse), kTransition);
    for (const int order : {1, 2, 3}) {
        const double frequency = order * cycles;
        const auto expected = calcCoefficient(fine, 1.0 / kFine, frequency);
        INFO("order " << order << " of " << cycles << " Hz, " << std::abs(expected));
        // The ends, half an interval each, and the correction's fourth order.
        CHECK(std::abs(calcCoefficient(coarse, 1.0 / kCoarse, frequency) - expected) < 4e-3);
    }
}

TEST_CASE("Noise goes from a velocity, the motion stays", "[diagnose]") {
    const auto seed = wems::test::drawSeed();
    INFO("seed " << seed);
    std::mt19937_64 random(seed);
    constexpr double kInterval = 1e-3, kNoise = 2e-6;
    constexpr Eigen::Index kSamples = 12000;
    std::normal_distribution<double> gauss(0, kNoise);
    Eigen::VectorXd displacement_noise(kSamples + 2);
    for (double& value : displacement_noise) value = gauss(random);
    Eigen::MatrixXd clean(1, kSamples), noise(1, kSamples);
    for (Eigen::Index k = 0; k < kSamples; ++k) {
        // Logarithmic sweep 5 to 40 Hz; the first part creeps as friction that sticks does.
        const double t = static_cast<double>(k) * kInterval, rate = std::log(8.0) / 12;
        const double level = t < 4 ? 1e-3 : 0.05;
        clean(0, k) = level * std::sin(kTwoPi * 5 * std::expm1(rate * t) / rate);
        noise(0, k) = (displacement_noise[k + 2] - displacement_noise[k]) / (2 * kInterval);
    }
    const int frame = velocityNoiseFrame(kInterval, 5.0);
    Eigen::MatrixXd density(1, frame / 2 + 1);
    for (Eigen::Index b = 0; b < density.cols(); ++b) {
        const double rate = std::sin(kTwoPi * static_cast<double>(b) / frame) / kInterval;  // of central differences
        density(0, b) = rate * rate * 2 * kInterval * kNoise * kNoise;
    }
    const auto root = [](const Eigen::MatrixXd& row) {
        return row.norm() / std::sqrt(static_cast<double>(row.size()));
    };

    CHECK(root(removeVelocityNoise(clean, frame, kInterval, 0 * density) - clean) < 1e-12);
    CHECK(root(removeVelocityNoise(noise, frame, kInterval, density)) < 0.4 * root(noise));
    const Eigen::MatrixXd found = removeVelocityNoise(clean + noise, frame, kInterval, density);
    REQUIRE(root(noise) > 1.2e-3);  // more than what creeps
    CHECK(root((found - clean).middleCols(500, 3000)) < 0.25 * root(noise));
    CHECK(root((found - clean).middleCols(4500, 7000)) < 0.4 * root(noise));
}
