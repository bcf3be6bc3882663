// Shock response spectrum of a half-sine against the closed form, and limits at low and high frequency.
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>

#include "models/common/units.hpp"
#include "models/shock.hpp"

using namespace wems;
using Complex = std::complex<double>;

namespace {

/// Largest absolute acceleration, positive and negative, of an oscillator whose base accelerates as A sin(p t) for half
/// a period: particular and free solution in closed form, sampled finely.
std::pair<double, double> solveHalfSine(double amplitude, double pulse, double f, double quality) {
    const double zeta = 1 / (2 * quality), w = kTwoPi * f, wd = w * std::sqrt(1 - zeta * zeta), p = kPi / pulse;
    // z'' + 2ζω z' + ω² z = −A sin(pt): z = Im(Z e^{ipt}) + Re(C e^{λt}), λ = −ζω + iω_d.
    const Complex Z = -amplitude / Complex(w * w - p * p, 2 * zeta * w * p), lambda(-zeta * w, wd);
    const double z0 = -Z.imag(), v0 = -(Complex(0, p) * Z).imag();
    const Complex C(z0, (zeta * w * z0 + v0) / -wd);  // Re C = z0, Re(λ C) = v0
    double highest = 0, lowest = 0;
    const auto look = [&](double z, double v) {
        const double a = -(2 * zeta * w * v + w * w * z);
        highest = std::max(highest, a);
        lowest = std::min(lowest, a);
    };
    const auto at = [&](double t) {
        const Complex forced = Z * std::polar(1.0, p * t), free = C * std::exp(lambda * t);
        return std::pair<double, double>{forced.imag() + free.real(),
                                         (Complex(0, p) * forced).imag() + (lambda * free).real()};
    };
    const int steps = 20000;
    for (int k = 0; k <= steps; ++k) {
        const auto [z, v] = at(pulse * k / steps);
        look(z, v);
    }
    const auto [z1, v1] = at(pulse);
    for (int k = 0; k <= steps; ++k) {
        const double t = 1.0 / f * k / steps, e = std::exp(-zeta * w * t), c = std::cos(wd * t), s = std::sin(wd * t);
        const double z = e * (z1 * c + (v1 + zeta * w * z1) / wd * s);
        const double v = e * (v1 * c - (w * w * z1 + zeta * w * v1) / wd * s);
        look(z, v);
    }
    return {highest, -lowest};
}

Eigen::VectorXd makeHalfSine(double amplitude, double pulse, double rate, double length) {
    Eigen::VectorXd signal = Eigen::VectorXd::Zero(std::lround(length * rate));
    for (Eigen::Index k = 0; k < signal.size() && double(k) / rate < pulse; ++k)
        signal[k] = amplitude * std::sin(kPi * double(k) / rate / pulse);
    return signal;
}

}  // namespace

TEST_CASE("shock response of a half-sine: the closed form") {
    const double A = 50, T = 0.011, rate = 200000;
    const Eigen::VectorXd signal = makeHalfSine(A, T, rate, 0.05);
    const std::vector<double> frequency{10, 30, 60, 90, 150, 400, 1000};
    for (const double quality : {10.0, 50.0, 5.0}) {
        const ShockResponse response = calcShockResponse(signal, 1 / rate, frequency, quality);
        for (std::size_t i = 0; i < frequency.size(); ++i) {
            const auto [highest, lowest] = solveHalfSine(A, T, frequency[i], quality);
            CAPTURE(frequency[i], quality);
            const Eigen::Index k = i;
            // Straight lines between samples cut (πΔt/T)²/8 = 2.5e-7; the largest sample lies (ωΔt)²/8 below the peak.
            CHECK(response.positive[k] == Approx(highest).epsilon(2e-4));
            CHECK(response.negative[k] == Approx(lowest).epsilon(2e-4).margin(1e-3));
            CHECK(response.maximax[k] == std::max(response.positive[k], response.negative[k]));
        }
    }
}

TEST_CASE("far above the pulse's frequencies the mass follows its base") {
    const Eigen::VectorXd signal = makeHalfSine(7, 0.1, 10000, 0.2);
    const ShockResponse response = calcShockResponse(signal, 1e-4, {1000}, 10);
    CHECK(response.positive[0] == Approx(7).epsilon(0.01));
    CHECK(makeOctaves(5, 41, 3).size() == 10);
    CHECK(makeOctaves(5, 40, 1).back() == 40);
}
