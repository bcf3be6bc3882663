#include <catch2/catch.hpp>
#include <string>

#include "models/common/error.hpp"
#include "models/common/units.hpp"
#include "models/mount_forces.hpp"
#include "tests/models/random_values.hpp"

using namespace wems;
using Eigen::Vector3d;
using Eigen::VectorXd;
using wems::test::RandomValues;

namespace {

MountModel makeCross() {
    return readMountModel(std::string(WEMS_SOURCE_DIR) + "/models/shipped/smallsat_wems.toml");
}

MountModel makeSingleAxis() {
    return readMountModel(std::string(WEMS_SOURCE_DIR) + "/models/shipped/single_axis.toml");
}

}  // namespace

TEST_CASE("equilibrium without gravity is the rest position") {
    const StaticEquilibrium rest = findStaticEquilibrium(makeCross());
    CHECK(rest.mobile.p_GM.isZero(0));
    CHECK(rest.mobile.R_GM.isIdentity(0));
    CHECK(rest.eta.isZero(0));
}

TEST_CASE("equilibrium on the elastomer and on the stop, by hand") {
    MountModel model = makeSingleAxis();  // 2 kg on 2e4 N/m, stops of 2e5 N/m at 1 mm
    model.gravity = {0, 0, -9.0};
    CHECK(findStaticEquilibrium(model).mobile.p_GM.z() == Approx(-18 / 2e4).epsilon(1e-9));
    model.gravity = {0, 0, -30.0};  // 60 N: 20 N at the gap, then 2.2e5 N/m
    CHECK(findStaticEquilibrium(model).mobile.p_GM.z() == Approx(-1e-3 - 40 / 2.2e5).epsilon(1e-9));
}

TEST_CASE("equilibrium starts inside a stop where the offset says so") {
    MountModel model = makeSingleAxis();
    model.connections[0].axis[2].offset = 1.5e-3;  // 0.5 mm inside of the stop on side +
    // k q + k_s (q + 0.5 mm) = 0
    CHECK(findStaticEquilibrium(model).mobile.p_GM.z() == Approx(-2e5 * 0.5e-3 / 2.2e5).epsilon(1e-9));
}

TEST_CASE("equilibrium on a bracket: deflections in series") {
    MountModel model = makeSingleAxis();
    model.gravity = {0, 0, -9.0};
    BracketMode mode;
    mode.frequency = 40;
    mode.translation = {0, 0, 0.5};
    model.bracket = {mode};
    const StaticEquilibrium rest = findStaticEquilibrium(model);
    const double omega = kTwoPi * 40;
    const double eta = -0.5 * 18 / (omega * omega);
    REQUIRE(rest.eta.size() == 1);
    CHECK(rest.eta[0] == Approx(eta).epsilon(1e-9));
    CHECK(rest.mobile.p_GM.z() == Approx(0.5 * eta - 18 / 2e4).epsilon(1e-9));
}

TEST_CASE("equilibrium is one: nothing moves from there, relaxed states included") {
    const unsigned seed = GENERATE(range(1U, 15U));
    CAPTURE(seed);
    RandomValues random(seed);
    MountModel model = makeCross();
    for (Connection& connection : model.connections) {
        for (AxisLaw& axis : connection.axis) {
            axis.loss_factor = random.chance() ? 0.1 : 0.0;
            if (random.chance()) axis.relaxation = Relaxation{0.3, 0.01};
            if (random.chance()) axis.friction = Friction{5, 1e-3, 1e5};
            axis.cubic = random.number(0, 1e10);
        }
    }
    model.gravity = random.vector(10);
    const StaticEquilibrium rest = findStaticEquilibrium(model);
    const MountForces forces(model);
    const Bracket bracket(model.bracket);
    const VectorXd still = VectorXd::Zero(rest.eta.size());
    REQUIRE(rest.states.size() == forces.stateCount());
    VectorXd zdot(rest.states.size()), modal(rest.eta.size());
    Wrench on_mobile, on_fixed;
    forces.calc(rest.mobile, bracket.calcMotion(rest.eta, still), 0, rest.states.data(), on_mobile, on_fixed,
                zdot.data());
    const Vector3d weight = model.body.mass * model.gravity;
    CHECK((on_mobile.force + weight).norm() < 1e-8 * weight.norm());
    const Vector3d arm = rest.mobile.R_GM * model.body.center_of_gravity;
    CHECK((on_mobile.moment + Vector3d(arm.y() * weight.z() - arm.z() * weight.y(),
                                       arm.z() * weight.x() - arm.x() * weight.z(),
                                       arm.x() * weight.y() - arm.y() * weight.x()))
              .norm() < 1e-8 * weight.norm());
    CHECK(zdot.cwiseAbs().maxCoeff() < 1e-12);  // rounding of q (1e-17 m) over the shortest time constant (2 ms)
    bracket.calcAccelerations(rest.eta, still, on_fixed, Vector3d::Zero(), Vector3d::Zero(), modal);
    CHECK(modal.norm() < 1e-8 * weight.norm());
}

TEST_CASE("no stiffness under the weight: an error, not a number") {
    MountModel model = makeSingleAxis();
    model.connections[0].axis[2] = AxisLaw{};
    model.gravity = {0, 0, -9.81};
    CHECK_THROWS_AS(findStaticEquilibrium(model), InputError);
}
