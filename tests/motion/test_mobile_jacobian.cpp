#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <random>
#include <stdexcept>

#include "identify/motion/mobile_jacobian.hpp"
#include "models/bryant.hpp"
#include "models/common/units.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

struct Case {
    unsigned seed = test::drawSeed();
    std::mt19937 random{seed};
    std::uniform_real_distribution<double> unit{-1, 1};
    Eigen::Matrix3Xd ends{3, 4};
    Eigen::Vector3d center{0.004, -0.003, 0.1415};

    Case() { ends << -0.1, 0.1, 0, 0, 0, 0, -0.1, 0.1, 0, 0, 0, 0; }
    Coordinates draw(double angle) {
        Coordinates q;
        for (int i = 0; i < 6; ++i) q[i] = (i < 3 ? 0.01 : angle) * unit(random);
        return q;
    }
};

Eigen::Index findRank(const Eigen::MatrixXd& matrix) {
    Eigen::FullPivLU<Eigen::MatrixXd> lu(matrix);
    lu.setThreshold(1e-9);
    return lu.rank();
}

TEST_CASE("Jacobian agrees with central differences up to 80 degrees") {
    Case c;
    CAPTURE(c.seed);
    const MobileJacobian jacobian(c.ends, c.center);
    for (int trial = 0; trial < 50; ++trial) {
        const Coordinates q = c.draw(80 * kPi / 180);
        const auto J = jacobian.calcJacobian(q);
        REQUIRE(J.rows() == 12);
        for (int i = 0; i < 6; ++i) {
            const double h = 1e-4;
            const auto at = [&](double s) {
                Coordinates moved = q;
                moved[i] += s;
                return jacobian.calcPositions(moved);
            };
            const Eigen::Matrix3Xd slope = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
            REQUIRE((J.col(i) - Eigen::Map<const Eigen::VectorXd>(slope.data(), 12)).norm() < 1e-11);
        }
    }
}

TEST_CASE("Power of end forces equals power of generalised forces and of the wrench") {
    Case c;
    CAPTURE(c.seed);
    const MobileJacobian jacobian(c.ends, c.center);
    for (int trial = 0; trial < 50; ++trial) {
        const Coordinates q = c.draw(80 * kPi / 180), rates = c.draw(3.0);
        Eigen::Matrix3Xd f(3, 4);
        for (Eigen::Index i = 0; i < f.size(); ++i) f.data()[i] = 100 * c.unit(c.random);
        const Eigen::Map<const Eigen::VectorXd> forces(f.data(), 12);
        const Coordinates generalized = jacobian.calcJacobian(q).transpose() * forces;
        const double power = forces.dot(jacobian.calcJacobian(q) * rates);
        CHECK(generalized.dot(rates) == Approx(power).margin(1e-9));
        // By hand: total force and moment about the CoG.
        const Coordinates wrench = jacobian.calcWrench(q, generalized);
        const Eigen::Matrix3Xd positions = jacobian.calcPositions(q);
        Eigen::Vector3d moment = Eigen::Vector3d::Zero();
        for (int i = 0; i < 4; ++i) moment += (positions.col(i) - q.head<3>()).cross(f.col(i));
        CHECK((wrench.head<3>() - f.rowwise().sum()).norm() < 1e-9);
        CHECK((wrench.tail<3>() - moment).norm() < 1e-9);
        const Eigen::Vector3d w = bryantRatesToAngularVelocity(q.tail<3>()) * rates.tail<3>();
        CHECK(wrench.head<3>().dot(rates.head<3>()) + wrench.tail<3>().dot(w) == Approx(power).margin(1e-9));
    }
}

TEST_CASE("Jacobian is singular at beta = ±90 degrees only, and the program says so") {
    Case c;
    CAPTURE(c.seed);
    const MobileJacobian jacobian(c.ends, c.center);
    Coordinates q = c.draw(1.0);
    for (const double beta : {-kPi / 2, kPi / 2}) {
        q[4] = beta;
        CHECK(findRank(jacobian.calcJacobian(q)) == 5);
        CHECK(findRank(jacobian.calcVelocityJacobian(q)) == 6);
        CHECK_THROWS_AS(jacobian.calcWrench(q, Coordinates::Ones()), std::domain_error);
        q[4] = beta * 0.99;
        CHECK(findRank(jacobian.calcJacobian(q)) == 6);
        CHECK_NOTHROW(jacobian.calcWrench(q, Coordinates::Ones()));
    }
}

}  // namespace
}  // namespace wems::identify
