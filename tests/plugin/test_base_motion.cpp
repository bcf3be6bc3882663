// The base's displacement against its acceleration, at every frequency of the band.
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

#include "models/common/units.hpp"
#include "models/excitation.hpp"
#include "plugin/base_motion.hpp"

using namespace wems;
using namespace wems::plugin;

namespace {

std::shared_ptr<const Drive> makeBaseDrive(std::unique_ptr<Signal> signal) {
    return makeSignalDrive(std::move(signal), Eigen::Vector3d::Zero(), {0, 0, 3}, false);
}

}  // namespace

TEST_CASE("base displacement times minus the frequency squared is the acceleration, from 5 to 2000 Hz") {
    const double T = 2;
    const int n = 16384;  // 8192 Hz
    const PowerSpectrum spectrum({5, 100, 2000}, {1, 4, 4}, Quantity::acceleration);
    const auto drive = makeBaseDrive(makeRandomFromSpectrum(spectrum, T, 7));
    const BaseMotion base(*drive, T);
    std::vector<double> acceleration, displacement, velocity;
    for (int k = 0; k < n; ++k) {
        const double t = k * T / n;
        acceleration.push_back(drive->calcBaseAcceleration(t).z());
        displacement.push_back(base.calcValue(t).displacement.z());
        velocity.push_back(base.calcValue(t).velocity.z());
    }
    Eigen::FFT<double> transform;
    std::vector<std::complex<double>> a, v, x;
    transform.fwd(a, acceleration);
    transform.fwd(v, velocity);
    transform.fwd(x, displacement);
    double worst = 0;
    for (int line = 10; line <= 4000; ++line) {
        const double omega = kTwoPi * line / T;
        const std::size_t k = line;
        worst = std::max(worst, std::abs(a[k] + omega * omega * x[k]) / std::abs(a[k]));
        worst = std::max(worst, std::abs(a[k] - std::complex<double>(0, omega) * v[k]) / std::abs(a[k]));
    }
    CHECK(worst < 1e-6);
    for (std::size_t line = 0; line < 9; ++line) CHECK(std::abs(x[line]) < 1e-6 * std::abs(x[10]));  // and no drift
}

TEST_CASE("a shock's base: straight lines about the pulse, the kink costs nothing") {
    const double T = 0.011;
    const auto drive = makeBaseDrive(makeHalfSine(T, 0.2));
    const BaseMotion base(*drive, drive->duration());
    const auto at = [&](double t) { return base.calcValue(t); };
    // Velocity gained: 3 · 2T/π.
    CHECK(at(0.15).velocity.z() - at(0).velocity.z() == Approx(6 * T / kPi).epsilon(1e-9));
    CHECK(at(0.15).velocity.z() == Approx(at(T).velocity.z()).epsilon(1e-12));
    CHECK(at(0.2).displacement.z() - at(0.1).displacement.z() == Approx(0.1 * at(0.15).velocity.z()).epsilon(1e-10));
}
