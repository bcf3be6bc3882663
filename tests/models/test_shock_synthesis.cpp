// Shocks made to a response spectrum, against an integration of the oscillators that is not the synthesis' own.
#include <catch2/catch.hpp>
#include <cmath>

#include "models/common/error.hpp"
#include "models/common/units.hpp"
#include "models/shock.hpp"

using namespace wems;

namespace {

/// Largest absolute acceleration of an oscillator on the shaken base, by classical Runge-Kutta.
double integrateOscillator(const Signal& base, double f, double quality, double highest) {
    const double omega = kTwoPi * f, zeta = 0.5 / quality, h = 1 / (60 * std::max(f, highest));
    double z = 0, v = 0, largest = 0;
    const auto slope = [&](double t, double q, double w) {
        return -base.value(t) - 2 * zeta * omega * w - omega * omega * q;
    };
    const double end = base.duration();
    for (double t = 0; t < end; t += h) {
        const double k1 = slope(t, z, v), v2 = v + h / 2 * k1, k2 = slope(t + h / 2, z + h / 2 * v, v2);
        const double v3 = v + h / 2 * k2, k3 = slope(t + h / 2, z + h / 2 * v2, v3), v4 = v + h * k3;
        const double k4 = slope(t + h, z + h * v3, v4);
        z += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
        v += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
        largest = std::max(largest, std::abs(2 * zeta * omega * v + omega * omega * z));
    }
    return largest;
}

}  // namespace

TEST_CASE("a shock has the response spectrum that is asked for, and leaves the base where it was") {
    const Breakpoints spectrum = parseShockSpectrum("frequency [Hz],shock [g]\n10,3\n80,40\n400,40\n", "srs.csv");
    CHECK(spectrum.calcValue(80) == Approx(40 * 9.80665));
    const ShockSynthesis shock = synthesizeShock(spectrum, 10, 0.2);
    CAPTURE(shock.least_decibels, shock.most_decibels);
    CHECK(shock.least_decibels > -3);
    CHECK(shock.most_decibels < 3);
    for (const double f : {10.0, 14.2, 33.0, 80.0, 155.0, 290.0, 400.0}) {
        const double decibels = 20 * std::log10(integrateOscillator(*shock.signal, f, 10, 400) / spectrum.calcValue(f));
        CAPTURE(f, decibels);
        // What the synthesis says of its grid, and 0.2 dB for what lies between.
        CHECK(decibels > shock.least_decibels - 0.2);
        CHECK(decibels < shock.most_decibels + 0.2);
    }
    // Velocity and displacement come back to zero: Simpson's rule.
    const double T = shock.signal->duration();
    const int steps = 40000;
    const double h = T / steps;
    double v = 0, x = 0, farthest = 0;
    for (int k = 0; k < steps; ++k) {
        const double a = shock.signal->value(k * h), b = shock.signal->value((k + 0.5) * h),
                     c = shock.signal->value((k + 1) * h);
        x += h * v + h * h / 6 * (a + 2 * b);
        v += h / 6 * (a + 4 * b + c);
        farthest = std::max(farthest, std::abs(x));
    }
    CHECK(std::abs(x) < 1e-4 * farthest);
    CHECK(std::abs(v) < 1e-4 * kTwoPi * 10 * farthest);
}

TEST_CASE("shock spectra that are none, or that no wavelets meet, are refused") {
    CHECK_THROWS_AS(parseShockSpectrum("10,3\n", "srs.csv"), InputError);
    CHECK_THROWS_AS(parseShockSpectrum("10,3\n80,-1\n", "srs.csv"), InputError);
    CHECK_THROWS_AS(parseShockSpectrum("f [Hz],a [mm]\n10,3\n80,1\n", "srs.csv"), InputError);
    // Falls by 60 dB within an octave: what rings at 100 Hz shakes an oscillator at 200 Hz more.
    CHECK_THROWS_WITH(synthesizeShock({{100, 200}, {1000, 1}}, 10, 0.1), Catch::Contains("3 dB"));
}
