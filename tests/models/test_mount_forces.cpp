#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <vector>

#include "models/common/units.hpp"
#include "models/mount_forces.hpp"
#include "tests/models/random_values.hpp"

using namespace wems;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using wems::test::RandomValues;

namespace {

struct Situation {
    MountModel model;
    BodyMotion mobile;
    FrameMotion fixed;
    double t;
    std::vector<double> z, zdot;
};

Situation makeSituation(RandomValues& random) {
    Situation s{random.model(), random.mobileMotion(), random.fixedMotion(), random.number(0, 10), {}, {}};
    s.z.resize(MountForces(s.model).stateCount());
    for (double& state : s.z) state = random.number(-1e-5, 1e-5);
    s.zdot = s.z;
    return s;
}

struct Wrenches {
    Wrench on_mobile, on_fixed;
};

/// And the rates of the inner states, in `s.zdot`.
Wrenches calcWrenches(const MountForces& forces, Situation& s) {
    Wrenches w;
    forces.calc(s.mobile, s.fixed, s.t, s.z.data(), w.on_mobile, w.on_fixed, s.zdot.data());
    return w;
}

/// What the mount gives to both parts, W.
double calcPower(const Wrench& on_mobile, const Wrench& on_fixed, const Situation& s) {
    return on_mobile.force.dot(s.mobile.v_GM) + on_mobile.moment.dot(s.mobile.w_GM) + on_fixed.force.dot(s.fixed.v_GF) +
           on_fixed.moment.dot(s.fixed.w_GF);
}

/// The frames after a step h along their velocities.
BodyMotion advance(const BodyMotion& m, double h) {
    return {rotationFromVector(h * m.w_GM) * m.R_GM, m.p_GM + h * m.v_GM, m.w_GM, m.v_GM};
}
FrameMotion advance(const FrameMotion& f, double h) {
    return {rotationFromVector(h * f.w_GF) * f.R_GF, f.p_GF + h * f.v_GF, f.w_GF, f.v_GF};
}

}  // namespace

TEST_CASE("relative motion: by hand, and its velocity by finite differences") {
    // Fixed part turned by 90° about z; the mobile part not: the end (1, 0, 0) is seen at (0, −1, 0) from F.
    const FrameMotion turned{rotationFromVector({0, 0, kPi / 2}), {0, 0, 0.5}, Vector3d::Zero(), Vector3d::Zero()};
    const RelativeMotion seen = calcRelativeMotion({}, turned, {1, 0, 0});
    CHECK((seen.q - Vector3d(-1, -1, -0.5)).norm() < 1e-15);

    const unsigned seed = GENERATE(range(1U, 20U));
    CAPTURE(seed);
    RandomValues random(seed);
    const BodyMotion mobile = random.mobileMotion();
    const FrameMotion fixed = random.fixedMotion();
    const Vector3d r = random.vector(0.3);
    const double h = 1e-6;
    const Vector3d rate = (calcRelativeMotion(advance(mobile, h), advance(fixed, h), r).q -
                           calcRelativeMotion(advance(mobile, -h), advance(fixed, -h), r).q) /
                          (2 * h);
    CHECK((calcRelativeMotion(mobile, fixed, r).v - rate).norm() < 1e-8);
}

TEST_CASE("mount forces: total force and moment vanish, power is minus the sum of f v") {
    const unsigned seed = GENERATE(range(1U, 40U));
    CAPTURE(seed);
    RandomValues random(seed);
    Situation s = makeSituation(random);
    const MountForces forces(s.model);
    const auto [on_mobile, on_fixed] = calcWrenches(forces, s);
    const double size = 1 + on_mobile.force.norm();
    CHECK((on_mobile.force + on_fixed.force).norm() < 1e-12 * size);
    const Vector3d about_origin =
        on_mobile.moment + s.mobile.p_GM.cross(on_mobile.force) + on_fixed.moment + s.fixed.p_GF.cross(on_fixed.force);
    CHECK(about_origin.norm() < 1e-12 * size);

    const double power = calcPower(on_mobile, on_fixed, s);
    const Eigen::Matrix3Xd f = forces.calcConnectionForces(s.mobile, s.fixed, s.t, s.z.data());
    double sum = 0;
    for (int i = 0; i < forces.connectionCount(); ++i) {
        const auto& position = s.model.connections[i].position;
        sum += f.col(i).dot(calcRelativeMotion(s.mobile, s.fixed, position).v);
    }
    CHECK(power == Approx(-sum).epsilon(1e-10).margin(1e-9));
}

TEST_CASE("mount forces: power in is potential plus dissipation") {
    const unsigned seed = GENERATE(range(1U, 40U));
    CAPTURE(seed);
    RandomValues random(seed);
    Situation s = makeSituation(random);
    const MountForces forces(s.model);
    const auto [on_mobile, on_fixed] = calcWrenches(forces, s);
    const double power = calcPower(on_mobile, on_fixed, s);
    const double h = 1e-7;
    std::vector<double> ahead = s.z, behind = s.z;
    for (std::size_t i = 0; i < s.z.size(); ++i) {
        ahead[i] += h * s.zdot[i];
        behind[i] -= h * s.zdot[i];
    }
    const double rate = (forces.calcPotential(advance(s.mobile, h), advance(s.fixed, h), s.t, ahead.data()) -
                         forces.calcPotential(advance(s.mobile, -h), advance(s.fixed, -h), s.t, behind.data())) /
                        (2 * h);
    const double lost = forces.calcDissipatedPower(s.mobile, s.fixed, s.t, s.z.data());
    CHECK(lost >= 0);
    CHECK(-power == Approx(rate + lost).epsilon(1e-5).margin(1e-3));
}

TEST_CASE("mount forces: a turned and moving world changes nothing but the frame of the result") {
    const unsigned seed = GENERATE(range(1U, 20U));
    CAPTURE(seed);
    RandomValues random(seed);
    Situation s = makeSituation(random);
    const MountForces forces(s.model);
    const auto [on_mobile, on_fixed] = calcWrenches(forces, s);
    // The whole world moved by (R, p) and turning with w, drifting with v.
    const Matrix3d R = rotationFromVector(random.vector(2));
    const Vector3d p = random.vector(1), w = random.vector(1), v = random.vector(1);
    const BodyMotion mobile{R * s.mobile.R_GM, p + R * s.mobile.p_GM, R * s.mobile.w_GM + w,
                            R * s.mobile.v_GM + v + w.cross(R * s.mobile.p_GM)};
    const FrameMotion fixed{R * s.fixed.R_GF, p + R * s.fixed.p_GF, R * s.fixed.w_GF + w,
                            R * s.fixed.v_GF + v + w.cross(R * s.fixed.p_GF)};
    Wrench mobile_there, fixed_there;
    forces.calc(mobile, fixed, s.t, s.z.data(), mobile_there, fixed_there, nullptr);
    const double size = 1e-10 * (1 + on_mobile.force.norm());
    CHECK((mobile_there.force - R * on_mobile.force).norm() < size);
    CHECK((mobile_there.moment - R * on_mobile.moment).norm() < size);
    CHECK((fixed_there.moment - R * on_fixed.moment).norm() < size);
}

TEST_CASE("mount forces: swapping the bodies of a symmetric mount under small translation swaps the forces") {
    MountModel model;
    model.connections.resize(1);
    model.connections[0].position = {0.1, 0, 0};
    for (AxisLaw& axis : model.connections[0].axis) {
        axis.stiffness = 1e4;
        axis.damping = 20;
        axis.stops = {{Side::positive, 1e-3, 1e5, 0.5}, {Side::negative, 1e-3, 1e5, 0.5}};
    }
    const MountForces forces(model);
    BodyMotion mobile;
    FrameMotion fixed;
    mobile.p_GM = {2e-3, -1.5e-3, 3e-4};
    mobile.v_GM = {0.1, 0.2, -0.3};
    Wrench on_mobile, on_fixed, swapped_mobile, swapped_fixed;
    forces.calc(mobile, fixed, 0, nullptr, on_mobile, on_fixed, nullptr);
    std::swap(mobile.p_GM, fixed.p_GF);
    std::swap(mobile.v_GM, fixed.v_GF);
    forces.calc(mobile, fixed, 0, nullptr, swapped_mobile, swapped_fixed, nullptr);
    CHECK((swapped_fixed.force - on_mobile.force).norm() < 1e-12);
    CHECK((swapped_mobile.force - on_fixed.force).norm() < 1e-12);
}

TEST_CASE("mount forces: states of an axis stand where stateOffset says") {
    RandomValues random(7);
    MountModel model = random.model();
    model.connections.resize(1);
    for (AxisLaw& axis : model.connections[0].axis) axis = AxisLaw{};
    model.connections[0].axis[0].relaxation = Relaxation{0.1, 0.5};
    model.connections[0].axis[0].stiffness = 1e4;
    model.connections[0].axis[2].stiffness = 1e4;
    model.connections[0].axis[2].loss_factor = 0.1;
    const MountForces forces(model);
    REQUIRE(forces.stateCount() == 1 + forces.axis(0, 2).stateCount());
    CHECK(forces.stateOffset(0, 0) == 0);
    CHECK(forces.stateOffset(0, 2) == 1);
    std::vector<double> z(forces.stateCount(), 0.0), zdot(z);
    BodyMotion mobile;
    mobile.p_GM = {1e-3, 0, 2e-3};
    Wrench on_mobile, on_fixed;
    forces.calc(mobile, {}, 0, z.data(), on_mobile, on_fixed, zdot.data());
    CHECK(zdot[0] == Approx(1e-3 / 0.5));
    for (std::size_t b = 0; b < forces.axis(0, 2).branches().size(); ++b) {
        CHECK(zdot[1 + b] == Approx(2e-3 / forces.axis(0, 2).branches()[b].time_constant));
    }
}
