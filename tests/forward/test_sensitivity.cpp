// Jacobian and amplification of the forward model.
#include <catch2/catch.hpp>
#include <cmath>

#include "identify/forward/ensemble.hpp"
#include "models/common/error.hpp"
#include "tests/forward/forward_fixture.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

/// q = −a/ω² (1 − cos ω t) of the oscillator under this constant base acceleration a = 1 m/s², ω² = k/m.
Drive makeStepDrive(int samples) {
    const TimeGrid grid = test::makeGrid(1e-3, samples, 8);
    Eigen::Matrix3Xd base = Eigen::Matrix3Xd::Zero(3, samples);
    base.row(2).setOnes();
    return Drive::makeLoad(test::makeTimes(grid), {}, base, grid);
}

}  // namespace

TEST_CASE("the Jacobian is the derivative of the closed form") {
    const MountModel model = test::makeOscillator();
    const Drive drive = makeStepDrive(301);
    const Eigen::MatrixXd J = calcJacobian(model, drive, makeWholeRun(drive), {"1.z.stiffness", "body.mass"});
    REQUIRE(J.rows() == 3 * 301);
    const double omega = 100;
    for (int k : {50, 123, 300}) {
        const double t = drive.grid().sampleTime(k);
        const double by_omega_squared =
            (1 - std::cos(omega * t)) / std::pow(omega, 4) - t * std::sin(omega * t) / (2 * std::pow(omega, 3));
        CHECK(J(3 * k + 2, 0) == Approx(by_omega_squared / 2).epsilon(1e-4));
        CHECK(J(3 * k + 2, 1) == Approx(-by_omega_squared * 1e4 / 2).epsilon(1e-4));
    }
    CHECK_THROWS_AS(calcJacobian(model, drive, makeWholeRun(drive), {"7.z.stiffness"}), InputError);
}

TEST_CASE("a window's Jacobian leaves its initial state alone") {
    const MountModel model = test::makeOscillator();
    const Drive drive = makeStepDrive(301);
    ShootingWindow window{100, 2, ForwardModel(model).restState()};
    window.initial->mobile.p_GM.z() = 1e-3;
    const Eigen::MatrixXd J = calcJacobian(model, drive, window, {"1.z.stiffness"});
    CHECK(J(2, 0) == 0);
    CHECK(J(5, 0) == Approx(-1e-3 / 2 * 0.5e-6).epsilon(2e-2));  // −q/m · t²/2 after one millisecond
}

TEST_CASE("amplification grows with the stretch of phase that a parameter shifts, and explodes with deep contact") {
    MountModel model = test::makeOscillator();
    const double brief = calcAmplification(model, makeStepDrive(51));
    const double long_run = calcAmplification(model, makeStepDrive(2001));
    CHECK(brief < 5);
    CHECK(long_run > 10 * brief);  // phase error: half of ω t, up to 100 rad

    MountModel deep = test::makeCross();
    deep.bracket = test::makeBracketModes();
    for (Connection& connection : deep.connections)
        connection.axis[2].stops = {{Side::positive, 1e-4, 8e5, 0.0}, {Side::negative, 1e-4, 8e5, 0.0}};
    const TimeGrid grid = test::makeGrid(1e-3, 2001, 2);
    const auto amplify = [&](double load) {
        return calcAmplification(deep, Drive::makeLoad(test::makeTimes(grid), test::makeLoad(grid, load), {}, grid));
    };
    CHECK(amplify(300) > 10 * amplify(3));
}
