#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include "identify/problem/smoothing_kernel.hpp"
#include "models/common/units.hpp"
#include "tests/seed.hpp"

using namespace wems::identify;
using wems::kPi;
using wems::kTwoPi;

namespace {

constexpr double kInterval = 1e-3;
constexpr int kSamples = 8000;

double drawBetween(double lower, double upper, std::mt19937_64& random) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
}

/// Triangles at random times, as the accelerations that contacts make: slopes jump between samples.
struct Contacts {
    std::vector<double> start, width, height;

    explicit Contacts(std::mt19937_64& random) {
        for (int i = 0; i < 80; ++i) {
            start.push_back(drawBetween(0.1, kSamples * kInterval - 0.1, random));
            width.push_back(drawBetween(0.004, 0.012, random));
            height.push_back(drawBetween(1, 10, random) * (drawBetween(-1, 1, random) < 0 ? -1 : 1));
        }
    }

    Eigen::VectorXd sample() const {
        Eigen::VectorXd values = Eigen::VectorXd::Zero(kSamples);
        for (std::size_t i = 0; i < start.size(); ++i)
            for (int k = 0; k < kSamples; ++k)
                values[k] += height[i] * std::max(0.0, 1 - std::abs(k * kInterval - start[i]) / width[i]);
        return values;
    }

    /// Of the function of time, not of its samples.
    std::complex<double> calcTransform(double frequency) const {
        std::complex<double> sum = 0;
        for (std::size_t i = 0; i < start.size(); ++i) {
            const double x = kPi * frequency * width[i], sinc = std::sin(x) / x;
            sum += height[i] * width[i] * sinc * sinc * std::polar(1.0, -kTwoPi * frequency * start[i]);
        }
        return sum;
    }
};

RunMotion makeMotion() {
    RunMotion run;
    run.interval = kInterval;
    for (PartMotion* part : {&run.mobile, &run.fixed}) {
        part->a = part->alpha = Eigen::Matrix3Xd::Zero(3, kSamples);
        part->acceleration_measured = true;
    }
    return run;
}

}  // namespace

TEST_CASE("What contact folds near zero frequency is foretold from what stands below half the sampling rate",
          "[diagnose]") {
    const auto seed = wems::test::drawSeed();
    INFO("seed " << seed);
    std::mt19937_64 random(seed);
    const Contacts contacts(random);
    const Eigen::VectorXd samples = contacts.sample();
    double folded = 0;
    int count = 0;
    for (double f = 5; f < 50; f += 0.125, ++count) {
        std::complex<double> sampled = 0;
        for (int k = 0; k < kSamples; ++k) sampled += samples[k] * std::polar(kInterval, -kTwoPi * f * k * kInterval);
        folded += std::norm(sampled - contacts.calcTransform(f)) / (kSamples * kInterval * kInterval);
    }
    folded /= count;

    RunMotion run = makeMotion();
    run.mobile.a.row(0) = samples;
    run.fixed.a.row(0) = -0.3 * samples.transpose();
    const auto covariance = calcAliasing(run);
    CHECK(covariance(0, 0) > 0.5 * folded);
    CHECK(covariance(0, 0) < 2 * folded);
    CHECK(covariance(0, 6) == Approx(-0.3 * covariance(0, 0)));
    CHECK(covariance(6, 6) == Approx(0.09 * covariance(0, 0)));
    CHECK(covariance(1, 1) == 0);

    SECTION("not of a part whose accelerations were not measured") {
        run.fixed.acceleration_measured = false;
        const auto mobile_alone = calcAliasing(run);
        CHECK(mobile_alone(0, 0) == Approx(covariance(0, 0)));
        CHECK(mobile_alone.rightCols(6).isZero(1e-12 * covariance(0, 0)));
    }
    SECTION("whether its displacements were measured too or not") {
        run.mobile.displacement_measured = true;
        CHECK(calcAliasing(run).isApprox(covariance));
    }
    SECTION("and not of noise, which does not fold but is what it is") {
        // Of the noise's power 0.06 would count; of 720 frequencies what is left by chance is some per cent of that.
        constexpr double kNoise = 2;
        std::normal_distribution<double> normal(0, kNoise);
        for (int k = 0; k < kSamples; ++k) run.mobile.a(1, k) = normal(random);
        run.mobile.acceleration_density = NoiseDensity(kNoise * kNoise);
        run.mobile.acceleration_covariance(1, 1) = 1;
        CHECK(calcAliasing(run)(1, 1) < 0.3 * 0.06 * kNoise * kNoise);
    }
}

TEST_CASE("Behind a filter that suits the sampling rate nothing folds", "[diagnose]") {
    RunMotion run = makeMotion();
    double largest = 0;
    for (int k = 0; k < kSamples; ++k) {
        // A pulse of 20 ms with tails that vanish: nothing of it reaches 0.4 of the sampling rate.
        const double t = (k - 0.5 * kSamples) * kInterval / 0.02;
        run.mobile.a(2, k) = 10 * std::exp(-0.5 * t * t);
        largest = std::max(largest, run.mobile.a(2, k));
    }
    CHECK(calcAliasing(run).norm() < 1e-12 * largest * largest);
}
