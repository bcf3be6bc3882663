#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <vector>

#include "models/axis_law.hpp"
#include "models/common/units.hpp"

using namespace wems;

namespace {

/// Complex stiffness by steady-state simulation of the force law itself: the states follow their own derivative.
std::complex<double> measureComplexStiffness(const AxisForce& force, double frequency) {
    const double omega = kTwoPi * frequency;
    const int steps_per_period = 400, periods = 60;
    const double dt = 1 / frequency / steps_per_period;
    std::vector<double> z(force.stateCount()), a(z), b(z), middle(z);
    std::complex<double> sum = 0;
    for (int i = 0; i < steps_per_period * periods; ++i) {
        const double t = i * dt;
        const auto q = [&](double time) { return 1e-3 * std::cos(omega * time); };
        const auto v = [&](double time) { return -1e-3 * omega * std::sin(omega * time); };
        if (i >= steps_per_period * (periods - 1)) {
            sum += force.calcForce(q(t), v(t), 0, z.data()) * std::polar(1.0, -omega * t);
        }
        force.calcStateDerivative(q(t), v(t), z.data(), a.data());
        for (std::size_t k = 0; k < z.size(); ++k) middle[k] = z[k] + 0.5 * dt * a[k];
        force.calcStateDerivative(q(t + dt / 2), v(t + dt / 2), middle.data(), b.data());
        for (std::size_t k = 0; k < z.size(); ++k) z[k] += dt * b[k];
    }
    return sum * 2.0 / (steps_per_period * 1e-3);
}

}  // namespace

TEST_CASE("structural damping: constant loss modulus over the band, storage modulus k in its middle") {
    AxisLaw law;
    law.stiffness = 1e5;
    law.loss_factor = GENERATE(0.02, 0.1, 0.4);
    const AxisForce force(law);
    const Band band = structuralBand();
    CHECK(measureComplexStiffness(force, std::sqrt(band.lower * band.upper)).real() == Approx(1e5).epsilon(1e-3));
    for (double f = band.lower; f <= band.upper * 1.001; f *= std::pow(10.0, 0.1)) {
        CAPTURE(law.loss_factor, f);
        CHECK(measureComplexStiffness(force, f).imag() == Approx(law.loss_factor * 1e5).epsilon(5e-3));
    }
}

TEST_CASE("structural damping: no branch is negative, and the largest loss factor leaves no static stiffness") {
    AxisLaw law;
    law.stiffness = 1e5;
    law.loss_factor = largestLossFactor() * (1 - 1e-9);
    const AxisForce force(law);
    for (const MaxwellBranch& branch : force.branches()) CHECK(branch.stiffness > 0);
    CHECK(force.calcStaticStiffness(0) > 0);
    CHECK(force.calcStaticStiffness(0) < 1);
}
