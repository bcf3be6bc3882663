// Packs and small matrices: each lane as `double` has it, each product as Eigen has it.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/forward/pack.hpp"
#include "models/hysteresis_terms.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;

TEMPLATE_TEST_CASE_SIG("pack: every function of every lane is that of the number there", "", ((int lanes), lanes), 2, 4,
                       8) {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<> normal;
    for (int run = 0; run < 100; ++run) {
        Pack<lanes> a(0.0), b(0.0);
        double x[lanes], y[lanes];
        for (int i = 0; i < lanes; ++i) {
            setLane(a, i, x[i] = normal(random));
            setLane(b, i, y[i] = normal(random));
        }
        Pack<lanes> sum = a, difference = a;
        sum += b;
        difference -= b;
        for (int i = 0; i < lanes; ++i) {
            CHECK(lane(a + b, i) == x[i] + y[i]);
            CHECK(lane(sum, i) == x[i] + y[i]);
            CHECK(lane(a - b, i) == x[i] - y[i]);
            CHECK(lane(difference, i) == x[i] - y[i]);
            CHECK(lane(a * b, i) == x[i] * y[i]);
            CHECK(lane(a / b, i) == x[i] / y[i]);
            CHECK(lane(-a, i) == -x[i]);
            CHECK(lane(2.5 * a, i) == 2.5 * x[i]);
            CHECK(lane(positivePart(a), i) == std::max(0.0, x[i]));
            CHECK(lane(least(a, b), i) == std::min(x[i], y[i]));
            CHECK(lane(whereNegative(a, b, Pack<lanes>(7.0)), i) == (x[i] < 0 ? y[i] : 7.0));
            CHECK(lane(reciprocalRoot(a * a), i) == Approx(1 / std::abs(x[i])).epsilon(1e-14));
            CHECK(lane(hyperbolicTangent(a), i) == Approx(std::tanh(x[i])).epsilon(1e-14));
            CHECK(lane(decayedPart(a), i) ==
                  Approx(x[i] > 0 ? 1 - std::exp(-x[i]) : x[i]).epsilon(1e-14).margin(1e-15));
            CHECK(lane(perNumber([](double p, double q) { return p + 2 * q; }, a, b), i) == x[i] + 2 * y[i]);
        }
    }
}

TEST_CASE("small matrices: sums, products and loads as Eigen has them, columns first") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<> normal;
    Eigen::Matrix3d M;
    Eigen::Vector3d a, b;
    for (double& value : M.reshaped()) value = normal(random);
    for (double& value : a) value = normal(random);
    for (double& value : b) value = normal(random);
    const auto m = Mat3<double>::load(M.data());
    const auto u = Vec3<double>::load(a.data()), v = Vec3<double>::load(b.data());
    const auto isNear = [](const Vec3<double>& found, const Eigen::Vector3d& expected) {
        Eigen::Vector3d stored;
        found.store(stored.data());
        return (stored - expected).norm() < 1e-14 * (1 + expected.norm());
    };
    CHECK(isNear(u + v, a + b));
    CHECK(isNear(u - v, a - b));
    CHECK(isNear(3.0 * u, 3 * a));
    CHECK(isNear(cross(u, v), a.cross(b)));
    CHECK(dot(u, v) == Approx(a.dot(b)));
    CHECK(isNear(m * u, M * a));
    CHECK(isNear(transposed(m, u), M.transpose() * a));
}
