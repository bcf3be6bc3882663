// Floquet multipliers against closed forms.
#include <catch2/catch.hpp>
#include <cmath>

#include "models/common/units.hpp"
#include "models/damped_modes.hpp"
#include "models/periodic/harmonic_balance.hpp"
#include "tests/models/oscillator.hpp"
#include "tests/plugin/sample_models.hpp"

using namespace wems;
using Complex = std::complex<double>;

TEST_CASE("of a linear device the multipliers are the exponentials of its poles") {
    MountModel model = test::withBracket(test::makeRigidModel());
    for (Connection& connection : model.connections)
        for (AxisLaw& law : connection.axis) {
            law.damping = 30;
            law.relaxation = Relaxation{0.3, 0.01};
        }
    model.body.spin = {0, 0, 0.3};
    const PeriodicSystem system(model, {{0, 0, 10}, Eigen::Vector3d::Zero()});
    const HarmonicBalance balance(system, 31);
    const double f = 17;
    const Eigen::VectorXd Q = balance.calcLinearMotion(balance.calcLinear(f));
    const Eigen::VectorXcd multipliers = calcFloquetMultipliers(balance, Q, f);
    CHECK(findInstability(multipliers) == Instability::none);
    int compared = 0;
    for (const DampedMode& mode : findDampedModes(system.linear())) {
        const Complex pole = kTwoPi * mode.frequency *
                             Complex(-mode.damping_ratio, std::sqrt(1 - mode.damping_ratio * mode.damping_ratio));
        const Complex expected = std::exp(pole / f);
        CAPTURE(mode.frequency, expected);
        // The midpoint rule's phase error, (2π f/(f₀ N))²/12 of the angle 2π f/f₀.
        const double angle = kTwoPi * mode.frequency / f, error = std::pow(angle / double(balance.samples()), 2) / 12;
        CHECK((multipliers.array() - expected).abs().minCoeff() < 2 * angle * error * std::abs(expected) + 1e-9);
        ++compared;
    }
    CHECK(compared == 10);
}

TEST_CASE("what the largest multiplier tells") {
    const auto tell = [](Complex first) {
        Eigen::VectorXcd multipliers(2);
        multipliers << first, 0.1;
        return findInstability(multipliers);
    };
    CHECK(tell(0.99) == Instability::none);
    CHECK(tell(1.01) == Instability::real);
    CHECK(tell(-1.01) == Instability::period_doubling);
    CHECK(tell(Complex(0.8, 0.7)) == Instability::neimark_sacker);
}
