#include <catch2/catch.hpp>
#include <cmath>

#include "models/bracket.hpp"
#include "models/bryant.hpp"
#include "models/common/units.hpp"
#include "tests/models/random_values.hpp"

using namespace wems;
using Eigen::Vector3d;
using Eigen::VectorXd;
using wems::test::RandomValues;

namespace {

Bracket makeBracket(RandomValues& random, int count) {
    std::vector<BracketMode> modes;
    for (int i = 0; i < count; ++i) {
        modes.push_back({random.number(10, 200), random.number(0, 0.05), random.vector(0.3), random.vector(3),
                         random.vector(0.3), random.vector(10)});
    }
    return Bracket(modes);
}

}  // namespace

TEST_CASE("bracket: velocities and accelerations are the time derivatives of the pose") {
    const unsigned seed = GENERATE(range(1U, 20U));
    const double size = GENERATE(1e-3, 0.3);
    CAPTURE(seed, size);
    RandomValues random(seed);
    const Bracket bracket = makeBracket(random, 4);
    const VectorXd eta = random.vector(4, size), rate = random.vector(4, 1), second = random.vector(4, 1);
    const auto motion = [&](double t) {
        return bracket.calcMotion(eta + t * rate + 0.5 * t * t * second, rate + t * second);
    };
    const double h = 1e-6;
    const FrameMotion now = motion(0), ahead = motion(h), behind = motion(-h);
    CHECK(now.R_GF.isUnitary(1e-13));
    CHECK(((ahead.p_GF - behind.p_GF) / (2 * h) - now.v_GF).norm() < 1e-8);
    const Eigen::Matrix3d spin = (ahead.R_GF - behind.R_GF) / (2 * h) * now.R_GF.transpose();
    CHECK((spin - crossMatrix(now.w_GF)).norm() < 1e-7 * (1 + now.w_GF.squaredNorm()));
    const auto acceleration = bracket.calcAcceleration(eta, rate, second);
    CHECK(((ahead.v_GF - behind.v_GF) / (2 * h) - acceleration.linear).norm() < 1e-7);
    CHECK(((ahead.w_GF - behind.w_GF) / (2 * h) - acceleration.angular).norm() < 1e-6 * (1 + now.w_GF.squaredNorm()));
}

TEST_CASE("bracket: power of wrench and load equals the change of energy plus what the dampers lose") {
    const unsigned seed = GENERATE(range(1U, 20U));
    CAPTURE(seed);
    RandomValues random(seed);
    const Bracket bracket = makeBracket(random, 5);
    const VectorXd eta = random.vector(5, 0.2), rate = random.vector(5, 1);
    const Wrench wrench{random.vector(10), random.vector(100)};
    const Vector3d load = random.vector(100);
    VectorXd second(5);
    bracket.calcAccelerations(eta, rate, wrench, load, Vector3d::Zero(), second);
    const FrameMotion motion = bracket.calcMotion(eta, rate);
    Vector3d load_velocity = Vector3d::Zero();
    for (int j = 0; j < 5; ++j) load_velocity += bracket.modes()[j].load_translation * rate[j];
    const double power = wrench.force.dot(motion.v_GF) + wrench.moment.dot(motion.w_GF) + load.dot(load_velocity);
    const double h = 1e-7;
    const double energy_rate = (bracket.calcEnergy(eta + h * rate, rate + h * second) -
                                bracket.calcEnergy(eta - h * rate, rate - h * second)) /
                               (2 * h);
    const double lost = bracket.calcDissipatedPower(rate);
    CHECK(lost >= 0);
    CHECK(power == Approx(energy_rate + lost).epsilon(1e-6).margin(1e-4));
}

TEST_CASE("bracket: a single mode rings at its frequency with its damping, driven by base acceleration too") {
    BracketMode mode;
    mode.frequency = 30;
    mode.damping_ratio = 0.02;
    mode.base_participation = {0, 0, 4};
    const Bracket bracket({mode});
    const double omega = kTwoPi * 30;
    VectorXd second(1);
    bracket.calcAccelerations(VectorXd::Constant(1, 0.5), VectorXd::Constant(1, 3.0), {}, Vector3d::Zero(), {0, 0, 2},
                              second);
    CHECK(second[0] == Approx(-omega * omega * 0.5 - 2 * 0.02 * omega * 3 - 4 * 2));
}

TEST_CASE("bracket: without modes the fixed part stands still") {
    const Bracket bracket({});
    const FrameMotion motion = bracket.calcMotion(VectorXd(0), VectorXd(0));
    CHECK(motion.R_GF.isIdentity(0));
    CHECK(motion.p_GF.isZero(0));
    CHECK(motion.w_GF.isZero(0));
}
