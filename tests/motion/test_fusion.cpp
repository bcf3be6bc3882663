#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "identify/motion/fusion.hpp"
#include "models/common/units.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

constexpr double h = 1e-3;

struct Trajectory {
    Eigen::VectorXd x, v, a;
};

Trajectory makeSine(double frequency, Eigen::Index n) {
    Trajectory result{Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n)};
    const double w = kTwoPi * frequency;
    for (Eigen::Index k = 0; k < n; ++k) {
        const double phase = w * h * static_cast<double>(k) + 0.3;
        result.x[k] = std::sin(phase);
        result.v[k] = w * std::cos(phase);
        result.a[k] = -w * w * std::sin(phase);
    }
    return result;
}

/// A mass on a spring that meets a stop: m x'' = −k x − k_s max(0, x − c), in closed form sampled from steps of 1 µs
/// (velocity Verlet, error 1e-7 of the amplitude).
Trajectory makeImpacts(Eigen::Index n, double interval = h) {
    const double k = std::pow(kTwoPi * 20, 2), stop = 1.6e5, clearance = 1.0e-3;
    const auto force = [&](double x) { return -k * x - (x > clearance ? stop * (x - clearance) : 0); };
    const double step = 1e-6;
    double x = 0, v = 0.25, a = force(x);
    Trajectory result{Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n)};
    for (Eigen::Index i = 0; i < n; ++i) {
        result.x[i] = x;
        result.v[i] = v;
        result.a[i] = a;
        for (int j = 0; j < static_cast<int>(interval / step + 0.5); ++j) {
            x += step * v + 0.5 * step * step * a;
            const double next = force(x);
            v += 0.5 * step * (a + next);
            a = next;
        }
    }
    return result;
}

/// The same behind a Gaussian low pass of 0.8 sampling intervals, which leaves 4 % at half the sampling rate.
Trajectory makeFilteredImpacts(Eigen::Index n) {
    constexpr int finer = 8, reach = 5 * finer;
    const Trajectory fine = makeImpacts(finer * n + 2 * reach, h / finer);
    Eigen::VectorXd kernel(2 * reach + 1);
    for (int j = -reach; j <= reach; ++j) kernel[j + reach] = std::exp(-0.5 * std::pow(j / (0.8 * finer), 2));
    kernel /= kernel.sum();
    Trajectory result{Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n)};
    for (Eigen::Index k = 0; k < n; ++k) {
        result.x[k] = kernel.dot(fine.x.segment(finer * k, kernel.size()));
        result.v[k] = kernel.dot(fine.v.segment(finer * k, kernel.size()));
        result.a[k] = kernel.dot(fine.a.segment(finer * k, kernel.size()));
    }
    return result;
}

double rms(const Eigen::VectorXd& values) {
    return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

/// Gain of the estimate for each frequency, whichever of the two measurements it trusts more.
TEST_CASE("Fused motion has no bias in any band") {
    const Eigen::Index n = 4000;
    for (const double sigma_a : {1e-6, 1e-2, 1e2, 1e6}) {
        for (const double frequency : {0.5, 5.0, 16.0, 50.0, 120.0, 200.0}) {
            CAPTURE(sigma_a, frequency);
            const Trajectory truth = makeSine(frequency, n);
            const FusedSignal fused = fuseDisplacementAndAcceleration(truth.x, 1e-6, truth.a, sigma_a, h);
            const Eigen::Index margin = 20;  // ends: one-sided differences
            const double x_limit = 1e-3, v_limit = frequency < 130 ? 2e-3 : 1e-2;
            CHECK(rms((fused.x - truth.x).segment(margin, n - 2 * margin)) < x_limit * rms(truth.x));
            CHECK(rms((fused.v - truth.v).segment(margin, n - 2 * margin)) < v_limit * rms(truth.v));
        }
    }
}

/// The posterior of white measurements: at each frequency σ_x²/(1 + (σ_x |D²|/σ_a)²), with D² the second difference.
TEST_CASE("Fused displacement has the noise that theory allows") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, 1);
    const Eigen::Index n = 40000;
    const double sigma_x = 3e-6, sigma_a = 0.03;
    Eigen::VectorXd x(n), a(n);
    for (Eigen::Index k = 0; k < n; ++k) {
        x[k] = sigma_x * normal(random);
        a[k] = sigma_a * normal(random);
    }
    const FusedSignal fused = fuseDisplacementAndAcceleration(x, sigma_x, a, sigma_a, h);
    double variance = 0;
    const int bins = 20000;
    for (int i = 0; i < bins; ++i) {
        const double second = (2 - 2 * std::cos(kPi * (i + 0.5) / bins)) / (h * h);
        variance += sigma_x * sigma_x / (1 + std::pow(sigma_x * second / sigma_a, 2)) / bins;
    }
    CHECK(rms(fused.x) == Approx(std::sqrt(variance)).epsilon(0.1));
    CHECK(rms(fused.x) < 0.25 * sigma_x);
}

/// Contact for some 8 ms in each period: sampled accelerations miss part of the impulse, which must not show.
TEST_CASE("Kinks of the acceleration are neither smeared nor drift") {
    const Eigen::Index n = 3000;
    const Trajectory truth = makeImpacts(n);
    REQUIRE(truth.x.maxCoeff() > 1.2e-3);
    const double sigma_x = 3e-6, sigma_a = 0.03;
    const FusedSignal fused = fuseDisplacementAndAcceleration(truth.x, sigma_x, truth.a, sigma_a, h);
    CHECK((fused.x - truth.x).cwiseAbs().maxCoeff() < sigma_x);
    CHECK(rms(fused.x - truth.x) < 0.3 * sigma_x);
    CHECK(rms(fused.v - truth.v) < 5e-3 * rms(truth.v));
}

/// Behind an anti-alias filter nothing of the impulse is missed: the accelerations say as much as between contacts.
TEST_CASE("Edges that a filter has rounded cost nothing") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, 1);
    const Eigen::Index n = 8000;
    const Trajectory truth = makeFilteredImpacts(n);
    REQUIRE(truth.x.maxCoeff() > 1.2e-3);
    const double sigma_x = 3e-6, sigma_a = 0.03;
    Eigen::VectorXd x = truth.x, a = truth.a, free_x(n), free_a(n);
    for (Eigen::Index k = 0; k < n; ++k) {
        x[k] += free_x[k] = sigma_x * normal(random);
        a[k] += free_a[k] = sigma_a * normal(random);
    }
    const double noise = rms(fuseDisplacementAndAcceleration(free_x, sigma_x, free_a, sigma_a, h).x);
    const FusedSignal filtered = fuseDisplacementAndAcceleration(x, sigma_x, a, sigma_a, h, ContactEdges::filtered);
    const FusedSignal sampled = fuseDisplacementAndAcceleration(x, sigma_x, a, sigma_a, h, ContactEdges::sampled);
    CAPTURE(noise, rms(filtered.x - truth.x), rms(sampled.x - truth.x));
    CHECK(rms(filtered.x - truth.x) < 1.1 * noise);
    CHECK(rms(sampled.x - truth.x) > 1.1 * noise);
}

/// Small changes of both measurements, forwards through the fusion and backwards.
TEST_CASE("The fusion's adjoint takes of each measurement what the fusion does") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, 1);
    const auto draw = [&](Eigen::Index count) {
        return Eigen::VectorXd::NullaryExpr(count, [&] { return normal(random); }).eval();
    };
    const Eigen::Index n = 600;
    const Trajectory truth = makeImpacts(n);
    const double sigma_x = 3e-6, sigma_a = 0.03;
    const FusedSignal before = fuseDisplacementAndAcceleration(truth.x, sigma_x, truth.a, sigma_a, h);
    const Eigen::VectorXd influence = draw(n);
    Eigen::VectorXd of_x = influence;
    FusionAdjoint(before.weights, h).apply(of_x);
    const Eigen::VectorXd dx = sigma_x * draw(n);
    const double by_x =
        influence.dot(fuseDisplacementAndAcceleration(truth.x + dx, sigma_x, truth.a, sigma_a, h).x - before.x);
    CHECK(of_x.dot(dx) == Approx(by_x).epsilon(1e-6));
    // At kinks the weights follow the accelerations. Where the edges are taken as filtered they do not.
    const auto fuse = [&](const Eigen::VectorXd& a) {
        return fuseDisplacementAndAcceleration(truth.x, sigma_x, a, sigma_a, h, ContactEdges::filtered);
    };
    const FusedSignal even = fuse(truth.a);
    Eigen::VectorXd again = influence;
    const Eigen::VectorXd of_even = FusionAdjoint(even.weights, h).apply(again);
    const Eigen::VectorXd da = sigma_a * draw(n);
    CHECK(of_even.dot(da) == Approx(influence.dot(fuse(truth.a + da).x - even.x)).epsilon(1e-6));
    CHECK(before.weights.minCoeff() < 0.1 * even.weights.maxCoeff());
}

}  // namespace
}  // namespace wems::identify
