#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <stdexcept>

#include "models/bryant.hpp"
#include "models/common/units.hpp"
#include "tests/models/random_values.hpp"

using namespace wems;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using wems::test::RandomValues;

namespace {

Matrix3d turn(double angle, const Vector3d& axis) {
    return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

/// ω with [ω]× = R' Rᵀ, by central differences of R along a path.
template <class Path>
Vector3d measureAngularVelocity(Path rotation) {
    const double h = 1e-6;
    const Matrix3d S = (rotation(h) - rotation(-h)) / (2 * h) * rotation(0.0).transpose();
    return {S(2, 1), S(0, 2), S(1, 0)};
}

}  // namespace

TEST_CASE("Bryant angles are turns about x, the new y, the newest z") {
    const Vector3d angles(0.3, -0.7, 1.9);
    const Matrix3d product =
        turn(0.3, Vector3d::UnitX()) * turn(-0.7, Vector3d::UnitY()) * turn(1.9, Vector3d::UnitZ());
    CHECK(rotationFromBryant(angles).isApprox(product, 1e-15));
    CHECK((bryantFromRotation(product) - angles).norm() < 1e-14);
}

TEST_CASE("Bryant angles come back, and angular velocity agrees with finite differences") {
    const unsigned seed = GENERATE(range(1U, 50U));
    CAPTURE(seed);
    RandomValues random(seed);
    const Vector3d angles(random.number(-3.1, 3.1), random.number(-1.5, 1.5), random.number(-3.1, 3.1));
    const Vector3d rates = random.vector(2);
    CHECK((bryantFromRotation(rotationFromBryant(angles)) - angles).norm() < 1e-12);
    const Vector3d w = measureAngularVelocity([&](double t) { return rotationFromBryant(angles + t * rates); });
    CHECK((bryantRatesToAngularVelocity(angles) * rates - w).norm() < 1e-8);
    CHECK((angularVelocityToBryantRates(angles) * bryantRatesToAngularVelocity(angles)).isIdentity(1e-10));
}

TEST_CASE("Bryant angles say so where they are singular") {
    const double beta = GENERATE(kPi / 2, -kPi / 2);
    const Vector3d angles(0.4, beta, 0);
    CHECK_THROWS_AS(bryantFromRotation(rotationFromBryant(angles)), std::domain_error);
    CHECK_THROWS_AS(angularVelocityToBryantRates(angles), std::domain_error);
    CHECK(std::abs(bryantRatesToAngularVelocity(angles).determinant()) < 1e-15);
}

TEST_CASE("rotation vectors: exponential, inverse, and Jacobian, small and large") {
    const unsigned seed = GENERATE(range(1U, 20U));
    const double size = GENERATE(1e-9, 1e-4, 0.1, 0.1732, 0.1733, 1.0, 1.8);  // the series end at |v| = 0.3
    CAPTURE(seed, size);
    RandomValues random(seed);
    const Vector3d v = random.vector(size), rate = random.vector(1), second = random.vector(1);
    const double angle = v.norm();
    CHECK(rotationFromVector(v).isApprox(turn(angle, v / angle), 1e-14));
    if (angle < kPi) CHECK((vectorFromRotation(rotationFromVector(v)) - v).norm() <= 1e-14 + 1e-12 * angle);
    const Vector3d w = measureAngularVelocity([&](double t) { return rotationFromVector(v + t * rate); });
    CHECK((leftJacobian(v) * rate - w).norm() < 1e-8);
    // Angular acceleration along v(t) = v + t v' + t²/2 v''.
    const double h = 1e-5;
    const auto velocity = [&](double t) -> Vector3d {
        return leftJacobian(v + t * rate + 0.5 * t * t * second) * (rate + t * second);
    };
    const Vector3d acceleration = (velocity(h) - velocity(-h)) / (2 * h);
    CHECK((leftJacobian(v) * second + leftJacobianRate(v, rate) * rate - acceleration).norm() < 1e-7);
}

TEST_CASE("rotation vector of half a turn") {
    const Vector3d v = kPi * Vector3d(1, 2, -2) / 3;
    const Vector3d back = vectorFromRotation(turn(kPi, Vector3d(1, 2, -2) / 3));
    CHECK(std::min((back - v).norm(), (back + v).norm()) < 1e-7);
}

TEST_CASE("cross matrix") {
    const Vector3d a(1, 2, 3), b(-4, 5, 6);
    CHECK((crossMatrix(a) * b - a.cross(b)).norm() == 0);
}
