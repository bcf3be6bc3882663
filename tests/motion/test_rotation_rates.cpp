#include <catch2/catch.hpp>
#include <random>

#include "identify/motion/differentiation.hpp"
#include "models/bryant.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

/// Angular velocity by definition: [ω]× = R' Rᵀ, R' by a fourth-order difference along θ(t) = θ + θ' t + θ'' t²/2.
Eigen::Vector3d angularVelocityAt(const Eigen::Vector3d& theta, const Eigen::Vector3d& rate,
                                  const Eigen::Vector3d& second, double t) {
    const double h = 1e-3;
    const auto R = [&](double s) { return rotationFromVector(theta + rate * s + 0.5 * s * s * second); };
    const Eigen::Matrix3d slope = (8 * (R(t + h) - R(t - h)) - (R(t + 2 * h) - R(t - 2 * h))) / (12 * h);
    const Eigen::Matrix3d W = slope * R(t).transpose();
    return {W(2, 1), W(0, 2), W(1, 0)};
}

TEST_CASE("Angular velocity and acceleration are those of the rotation itself") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (const double size : {1e-6, 0.01, 0.19, 0.21, 1.0, 2.5}) {
        CAPTURE(size);
        Eigen::Vector3d theta(unit(random), unit(random), unit(random));
        theta *= size / theta.norm();
        const Eigen::Vector3d rate(unit(random), unit(random), unit(random));
        const Eigen::Vector3d second(unit(random), unit(random), unit(random));
        const Eigen::Vector3d w = angularVelocityAt(theta, rate, second, 0);
        CHECK((calcAngularVelocity(theta, rate) - w).norm() < 1e-10);
        const double h = 1e-3;
        const auto at = [&](double t) { return angularVelocityAt(theta, rate, second, t); };
        const Eigen::Vector3d alpha = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
        CHECK((calcAngularAcceleration(theta, rate, second) - alpha).norm() < 1e-8);
        CHECK((calcVectorRate(theta, w) - rate).norm() < 1e-9);
        CHECK((calcVectorAcceleration(theta, rate, alpha) - second).norm() < 1e-7);
    }
}

}  // namespace
}  // namespace wems::identify
