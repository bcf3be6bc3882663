#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/problem/band_limited_force.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

constexpr double kInterval = 1e-3;  // s

struct Sums {
    double impulse = 0, moment = 0;  // N s, N s²
};

Sums sumOver(const Eigen::VectorXd& force) {
    const Eigen::VectorXd time =
        Eigen::VectorXd::LinSpaced(force.size(), 0, static_cast<double>(force.size() - 1) * kInterval);
    return {force.sum() * kInterval, force.dot(time) * kInterval};
}

}  // namespace

// A mass that is thrown against a stop: δ = v τ − a τ²/2 for 0 < τ < T = 2 v/a. Impulse k ∫ δ = k v T²/6, as
// dissipation k χ δ δ' = k χ (δ²/2)' gives none; its moment is that of the middle, less k χ ∫ δ²/2 = k χ v² T³/60.
TEST_CASE("A touch of a stop has its impulse and moment wherever it falls between samples") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> draw(0, 1);
    double squares = 0;
    constexpr int trials = 400;
    double unit = 0;  // k v h², that an edge's impulse errs by parts of
    for (int trial = 0; trial < trials; ++trial) {
        const double speed = 0.1 + draw(random), duration = kInterval * (3 + 10 * draw(random));
        const double start = kInterval * (20 + draw(random)), deceleration = 2 * speed / duration;
        const double side = trial % 2 == 0 ? 1 : -1, clearance = 1e-3;
        AxisLaw law;
        law.stiffness = 1e5;  // no part of the stops
        law.offset = 2e-4;
        law.stops = {{side > 0 ? Side::positive : Side::negative, clearance, 4e5, 0.5 / speed * draw(random)}};
        constexpr Eigen::Index samples = 60;
        Eigen::VectorXd q(samples), v(samples);
        for (Eigen::Index k = 0; k < samples; ++k) {
            const double t = static_cast<double>(k) * kInterval - start;
            q[k] = side * (clearance + speed * t - 0.5 * deceleration * t * t) - law.offset;
            v[k] = side * (speed - deceleration * t);
        }
        const double impulse = side * 4e5 * speed * duration * duration / 6;
        const double moment = impulse * (start + 0.5 * duration) -
                              side * 4e5 * law.stops[0].dissipation * speed * speed * std::pow(duration, 3) / 60;
        unit = 4e5 * speed * kInterval * kInterval;
        CAPTURE(trial, speed, duration, start);
        const Sums limited = sumOver(calcStopForce(law, q, v, kInterval));
        CHECK(std::abs(limited.impulse - impulse) < 2e-3 * unit);
        CHECK(std::abs(limited.moment - moment) < 2e-3 * unit * samples * kInterval);
        const AxisForce force(law);
        double sampled = 0;
        for (Eigen::Index k = 0; k < samples; ++k)
            sampled += (force.calcForce(q[k], v[k], 0, nullptr) - law.stiffness * q[k]) * kInterval;
        squares += std::pow((sampled - impulse) / unit, 2) / trials;
    }
    // Two edges of B₂(θ)/2 each, of which the RMS over θ is 1/√180 / 2.
    CHECK(std::sqrt(squares) == Approx(std::sqrt(2.0 / 180) / 2).epsilon(0.25));
}

// Mean and correction leave h⁴ of the fourth derivative, 7/5760 of it, beside the midpoints' (h/16)²/24 of the second.
TEST_CASE("Where a stop is touched all the time its force is that of the samples") {
    AxisLaw law;
    law.stops = {{Side::positive, 1e-3, 4e5, 0.3}};
    constexpr Eigen::Index samples = 400;
    const double w = 2 * 3.14159265358979 * 40;
    Eigen::VectorXd q(samples), v(samples);
    for (Eigen::Index k = 0; k < samples; ++k) {
        const double t = static_cast<double>(k) * kInterval;
        q[k] = 3e-3 + 1e-3 * std::sin(w * t);
        v[k] = 1e-3 * w * std::cos(w * t);
    }
    const Eigen::VectorXd force = calcStopForce(law, q, v, kInterval);
    const AxisForce own(law);
    // At the ends half an interval's mean stands for the whole.
    for (Eigen::Index k = 2; k + 2 < samples; ++k) {
        CAPTURE(k);
        CHECK(force[k] == Approx(own.calcForce(q[k], v[k], 0, nullptr)).epsilon(3e-5));
    }
}

// A stop that is reached a little earlier changes the mean stiffness a little, as the share of time in contact does.
TEST_CASE("The stiffness of a stop is its own for the time that it is touched") {
    constexpr Eigen::Index samples = 1000;
    const double w = 2 * 3.14159265358979 * 23.6;
    Eigen::VectorXd q(samples), v(samples);
    for (Eigen::Index k = 0; k < samples; ++k) {
        const double t = static_cast<double>(k) * kInterval;
        q[k] = 1.5e-3 * std::sin(w * t);
        v[k] = 1.5e-3 * w * std::cos(w * t);
    }
    AxisLaw law;
    law.stiffness = 1e5;
    law.stops = {{Side::positive, 1e-3, 4e5, 0.3}, {Side::negative, 2e-3, 4e5, 0}};
    const auto mean = [&](double clearance) {
        law.stops[0].clearance = clearance;
        return calcStopStiffness(law, q, v, kInterval).mean();
    };
    double largest = 0;
    for (int i = 0; i < 40; ++i) {
        const double clearance = 1e-3 + 2.5e-6 * i;
        // 23.6 periods: of the last, which is not whole, the touch is.
        const double touched = 24 * 2 * std::acos(clearance / 1.5e-3) / w;
        CAPTURE(clearance);
        CHECK(mean(clearance) == Approx(4e5 * touched / (samples * kInterval)).epsilon(2e-3));
        largest = std::max(largest, std::abs(mean(clearance) - mean(clearance + 1e-9)));
    }
    // A sample that comes into contact at once would change it by 4e5 / 1000.
    CHECK(largest < 0.01 * 4e5 / samples);
}

TEST_CASE("A law without stops, and one whose stops are not reached, has no stop's force") {
    AxisLaw law;
    law.stiffness = 1e5;
    law.damping = 10;
    const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(50, -1e-3, 0.99e-3), v = Eigen::VectorXd::Constant(50, 0.04);
    CHECK(calcStopForce(law, q, v, kInterval).isZero(0.0));
    law.stops = {{Side::positive, 1e-3, 4e5, 0}, {Side::negative, 1.01e-3, 4e5, 0}};
    CHECK(calcStopForce(law, q, v, kInterval).isZero(0.0));
    CHECK(calcStopForce(law, Eigen::VectorXd(), Eigen::VectorXd(), kInterval).size() == 0);
}

// Against central differences of the force itself. Steps of a millionth of the motion move no edge of a contact over
// one of the pieces that an interval is summed over, but for a few in thousands.
TEST_CASE("A stop's force answers to a small change of the motion as differences say") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> draw(0, 1);
    AxisLaw law;
    law.stiffness = 1e5;  // no part of the stops
    law.offset = 1e-4 * draw(random);
    law.stops = {{Side::positive, 1e-3, 4e5, 0.5 * draw(random)}, {Side::negative, 1.1e-3, 3e5, 0.5 * draw(random)}};
    constexpr Eigen::Index samples = 2000;
    const double frequency = 20 + 30 * draw(random), other = 20 + 30 * draw(random), phase = draw(random);
    Eigen::VectorXd q(samples), v(samples), change(samples), rate(samples);
    for (Eigen::Index k = 0; k < samples; ++k) {
        const double t = static_cast<double>(k) * kInterval, w = 6.283 * frequency, u = 6.283 * other;
        q[k] = 1.5e-3 * std::sin(w * t);
        v[k] = 1.5e-3 * w * std::cos(w * t);
        change[k] = 1e-3 * std::sin(u * t + phase);
        rate[k] = 1e-3 * u * std::cos(u * t + phase);
    }
    const double step = 1e-6;
    const Eigen::VectorXd difference = (calcStopForce(law, q + step * change, v + step * rate, kInterval) -
                                        calcStopForce(law, q - step * change, v - step * rate, kInterval)) /
                                       (2 * step);
    const Eigen::VectorXd derivative = StopDerivative(law, q, v, kInterval).apply(change, rate);
    REQUIRE(difference.norm() > 0);
    CHECK((difference - derivative).norm() < 1e-3 * difference.norm());
}
