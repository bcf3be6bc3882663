// Poles, transfer functions and random response of the linear model, against closed forms and against the state space.
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <catch2/catch.hpp>
#include <cmath>

#include "models/common/error.hpp"
#include "models/common/units.hpp"
#include "models/damped_modes.hpp"
#include "models/linear_response.hpp"
#include "tests/models/oscillator.hpp"
#include "tests/plugin/sample_models.hpp"

using namespace wems;
using wems::test::makeOscillator;
using Complex = std::complex<double>;

namespace {

MountModel makeFullModel() {
    MountModel model = test::withLosses(test::withStops(test::withBracket(test::makeRigidModel())));
    model.gravity = {1, -2, -9.81};
    model.body.spin = {0.02, -0.05, 0.4};
    for (std::size_t j = 0; j < model.bracket.size(); ++j)
        model.bracket[j].base_participation = Eigen::Vector3d(0.7, -0.4, 0.9) * (1.0 + double(j));
    return model;
}

/// ∫ dω / ((ω0² − ω²)² + (2ζω0ω)²), in closed form by partial fractions over ω².
double integrateResonance(double omega0, double zeta, double from, double to) {
    const Complex lambda = omega0 * omega0 * Complex(1 - 2 * zeta * zeta, 2 * zeta * std::sqrt(1 - zeta * zeta)),
                  root = std::sqrt(lambda);
    const auto primitive = [&](double w) { return std::log((w - root) / (w + root)) / (2.0 * root); };
    return (primitive(to) - primitive(from)).imag() / lambda.imag();
}

}  // namespace

TEST_CASE("one degree of freedom: pole and transfer function as in the textbook") {
    const double m = 3, k = 4e4, c = 40;
    const LinearDynamics dynamics(makeOscillator(m, k, c));
    const double omega0 = std::sqrt(k / m), zeta = c / (2 * std::sqrt(k * m));
    const auto modes = findDampedModes(dynamics.system());
    REQUIRE(modes.size() == 6);
    for (std::size_t i = 0; i < 3; ++i) CHECK(modes[i].frequency == 0);  // nothing holds the rotations
    for (std::size_t i = 3; i < 6; ++i) {
        CHECK(modes[i].frequency == Approx(omega0 / kTwoPi).epsilon(1e-9));
        CHECK(modes[i].damping_ratio == Approx(zeta).epsilon(1e-9));
        CHECK(modes[i].damped_frequency == Approx(omega0 * std::sqrt(1 - zeta * zeta) / kTwoPi).epsilon(1e-9));
    }
    for (const double f : {0.1, 5.0, 18.0, 18.5, 200.0}) {
        const double w = kTwoPi * f;
        const auto response = dynamics.calcResponse(f, {Eigen::Vector3d::Zero(), Eigen::Vector3d(0, 0, 1)});
        const Complex q = -m / (k - m * w * w + Complex(0, c * w));
        CHECK(std::abs(response[0].relative.z() - q) < 1e-9 * std::abs(q));
        CHECK(std::abs(response[0].relative.x()) < 1e-9 * std::abs(q));
        CHECK(std::abs(response[0].force.z() - Complex(k, c * w) * q) < 1e-9 * std::abs(k * q));
        CHECK(std::abs(response[0].mobile_acceleration.z() - (1.0 - w * w * q)) < 1e-9);
        CHECK(std::abs(response[0].fixed_acceleration.z() - 1.0) < 1e-12);
    }
}

TEST_CASE("a Maxwell branch: the pole is a root of its cubic, the stiffness complex") {
    const double m = 2, k = 3e4, c = 5, ratio = 0.4, tau = 0.008;
    MountModel model = makeOscillator(m, k, c);
    model.connections[0].axis[2].relaxation = Relaxation{ratio, tau};
    const LinearDynamics dynamics(model);
    // (m s² + c s + k)(1 + s τ) + g s τ = 0, by Newton from the undamped pole.
    Complex s(0, std::sqrt(k * (1 + ratio) / m));
    for (int i = 0; i < 50; ++i) {
        const Complex p = (m * s * s + c * s + k) * (1.0 + s * tau) + ratio * k * s * tau;
        const Complex slope = (2 * m * s + c) * (1.0 + s * tau) + (m * s * s + c * s + k) * tau + ratio * k * tau;
        s -= p / slope;
    }
    const auto modes = findDampedModes(dynamics.system());
    const DampedMode& mode = modes.back();  // the stiffest: along z
    CHECK(mode.frequency == Approx(std::abs(s) / kTwoPi).epsilon(1e-9));
    CHECK(mode.damping_ratio == Approx(-s.real() / std::abs(s)).epsilon(1e-9));
    const double w = kTwoPi * 21;
    const Complex stiffness = k + Complex(0, c * w) + ratio * k * Complex(0, w * tau) / Complex(1, w * tau);
    const auto response = dynamics.calcResponse(21, {Eigen::Vector3d::Zero(), Eigen::Vector3d(0, 0, 1)});
    CHECK(std::abs(response[0].relative.z() * (stiffness - m * w * w) + m) < 1e-8 * m);
    CHECK(std::abs(response[0].force.z() - stiffness * response[0].relative.z()) < 1e-8);
}

TEST_CASE("a guided part on a bracket mode: base motion and load by hand") {
    // Only z is free relative to the fixed part, which one mode moves along x and z and carries the mass with it.
    const double m = 4, k = 5e4, c = 30, f = 30;
    MountModel model = makeOscillator(m, k, c);
    model.body.free = {false, false, true, false, false, false};
    model.load_point = LoadPoint{Part::mobile, Eigen::Vector3d::Zero()};
    BracketMode mode;
    mode.frequency = f;
    mode.damping_ratio = 0.02;
    mode.translation = {0.4, 0, 0.3};
    mode.base_participation = {1.1, -0.6, 2.3};
    model.bracket = {mode};
    const LinearDynamics dynamics(model);
    REQUIRE(dynamics.system().mass.rows() == 2);
    const Eigen::Vector3d phi = mode.translation, load(7, 3, -5), base(0.8, -0.3, 1.7);
    Eigen::Matrix2d M, C = Eigen::Matrix2d::Zero(), K = Eigen::Matrix2d::Zero();
    M << m, m * phi.z(), m * phi.z(), 1 + m * phi.squaredNorm();
    C.diagonal() << c, 2 * mode.damping_ratio * kTwoPi * f;
    K.diagonal() << k, kTwoPi * f * kTwoPi * f;
    const Eigen::Vector3d force = load - m * base;
    const Eigen::Vector2d right(force.z(), phi.dot(force) - mode.base_participation.dot(base));
    for (const double frequency : {3.0, 14.0, 25.0, 80.0}) {
        const double w = kTwoPi * frequency;
        const Eigen::Matrix2cd dynamic = (K - w * w * M).cast<Complex>() + Complex(0, w) * C;
        const Eigen::Vector2cd x = dynamic.partialPivLu().solve(right.cast<Complex>());
        const Eigen::Vector3cd fixed = base - w * w * (phi * x[1]);
        const Eigen::Vector3cd mobile = fixed - w * w * (Eigen::Vector3d::UnitZ() * x[0]);
        const ConnectionResponse response = dynamics.calcResponse(frequency, {load, base})[0];
        // The ends' motions are central differences.
        CHECK(std::abs(response.relative.z() - x[0]) < 1e-8 * std::abs(x[0]));
        CHECK(response.relative.head<2>().norm() < 1e-8 * std::abs(x[0]));
        CHECK(std::abs(response.force.z() - Complex(k, c * w) * x[0]) < 1e-8 * k * std::abs(x[0]));
        CHECK((response.fixed_acceleration - fixed).norm() < 1e-8 * fixed.norm());
        CHECK((response.mobile_acceleration - mobile).norm() < 1e-8 * mobile.norm());
    }
}

TEST_CASE("two degrees of freedom by hand: mount on a bracket mode, effective masses") {
    // The mobile mass on a bracket mode of modal mass M that moves along z: a chain of two masses.
    const double m = 4, k = 5e4, M = 10, f = 30;
    MountModel model = makeOscillator(m, k, 0);
    BracketMode mode;
    mode.frequency = f;
    mode.translation = {0, 0, 1 / std::sqrt(M)};
    mode.load_translation = mode.translation;
    mode.base_participation = {0, 0, std::sqrt(M)};
    model.bracket = {mode};
    const LinearDynamics dynamics(model);
    const double K = M * std::pow(kTwoPi * f, 2);
    // λ² − λ (K/M + k/M + k/m) + K k/(M m) = 0 for λ = ω².
    const double half = 0.5 * (K / M + k / M + k / m), product = K * k / (M * m);
    const double high = half + std::sqrt(half * half - product), low = product / high;
    const auto modes = findDampedModes(dynamics.system());
    std::vector<const DampedMode*> found;
    double total = 0;
    for (const DampedMode& each : modes) {
        total += each.effective_mass.z();
        if (each.effective_mass.z() > 1e-6) found.push_back(&each);
    }
    CHECK(total == Approx(m + M).epsilon(1e-9));
    REQUIRE(found.size() == 2);
    for (std::size_t i = 0; i < 2; ++i) {
        const double lambda = i == 0 ? low : high;
        CHECK(found[i]->frequency == Approx(std::sqrt(lambda) / kTwoPi).epsilon(1e-8));
        // Shape (bracket, mobile) = (k − m λ, k); effective mass (Σ m φ)²/Σ m φ².
        const double b = k - m * lambda;
        CHECK(found[i]->effective_mass.z() ==
              Approx(std::pow(M * b + m * k, 2) / (M * b * b + m * k * k)).epsilon(1e-7));
    }
}

TEST_CASE("the state space gives the same transfer functions and poles as the dynamic stiffness") {
    const MountModel model = makeFullModel();
    const LinearDynamics dynamics(model);
    const LinearSystem& system = dynamics.system();
    REQUIRE(system.branches.size() == 4);
    const Eigen::MatrixXd A = makeStateMatrix(system);
    const Eigen::Index n = system.mass.rows();
    Eigen::MatrixXd B = Eigen::MatrixXd::Zero(A.rows(), 6);
    B.block(n, 0, n, 3) = system.mass.inverse() * system.load;
    B.block(n, 3, n, 3) = system.mass.inverse() * system.base;
    for (const double f : {1.0, 11.0, 29.0, 64.0, 300.0}) {
        const Eigen::MatrixXcd resolvent =
            Complex(0, kTwoPi * f) * Eigen::MatrixXcd::Identity(A.rows(), A.rows()) - A.cast<Complex>();
        const Eigen::MatrixXcd states = resolvent.fullPivLu().solve(B.cast<Complex>());
        for (int input = 0; input < 6; ++input) {
            HarmonicInput drive;
            (input < 3 ? drive.load : drive.base)[input % 3] = 1;
            const Eigen::VectorXcd x = dynamics.calcMotion(f, drive);
            CHECK((x - states.col(input).head(n)).norm() < 1e-8 * x.norm());
        }
    }
    const Eigen::VectorXcd poles = A.eigenvalues();
    for (const DampedMode& mode : findDampedModes(system)) {
        const Complex pole = kTwoPi * mode.frequency *
                             Complex(-mode.damping_ratio, std::sqrt(1 - mode.damping_ratio * mode.damping_ratio));
        CAPTURE(mode.frequency, mode.damping_ratio);
        CHECK((poles.array() - pole).abs().minCoeff() < 1e-7 * std::abs(pole));
        // The shape solves (M s² + C s + K(s)) x = 0.
        Eigen::MatrixXcd D = pole * pole * system.mass + pole * system.damping + system.stiffness;
        for (const LinearBranch& b : system.branches) {
            const Eigen::RowVectorXd row = system.ends[std::size_t(b.connection)].row(b.axis);
            const Complex u = pole * b.branch.time_constant;
            D += (b.branch.stiffness * u / (1.0 + u)) * (row.transpose() * row).cast<Complex>();
        }
        CHECK((D * mode.shape).norm() < 1e-6 * D.norm() * mode.shape.norm());
    }
}

TEST_CASE("random response of one degree of freedom: closed form over a band") {
    const double m = 3, k = 4e4;
    const double omega0 = std::sqrt(k / m);
    for (const double zeta : {0.3, 0.02, 0.001}) {
        const LinearDynamics dynamics(makeOscillator(m, k, 2 * zeta * std::sqrt(k * m)));
        const PowerSpectrum flat({5, 11, 100}, {0.7, 0.7, 0.7}, Quantity::acceleration);
        const auto response =
            calcRandomResponse(dynamics, {Eigen::Vector3d::Zero(), Eigen::Vector3d(0, 0, 1)}, flat, {10, 20});
        const double square = 0.7 / kTwoPi * integrateResonance(omega0, zeta, kTwoPi * 5, kTwoPi * 100);
        CAPTURE(zeta);
        CHECK(response.rms[2] == Approx(std::sqrt(square)).epsilon(1e-8));
        CHECK(response.rms[0] == 0);
        CHECK(response.rms[11] == Approx(std::sqrt(0.7 * 95)).epsilon(1e-9));  // the fixed part is the base
        const Complex H = -1.0 / Complex(omega0 * omega0 - std::pow(kTwoPi * 20, 2), 2 * zeta * omega0 * kTwoPi * 20);
        CHECK(response.density(2, 1) == Approx(0.7 * std::norm(H)).epsilon(1e-9));
        // Lightly damped: zero crossings at the natural frequency.
        if (zeta < 0.002) CHECK(response.rate[2] == Approx(omega0 / kTwoPi).epsilon(0.01));
    }
}

TEST_CASE("a spectrum's breakpoints: slopes, mean square, units, errors") {
    // 6 dB/octave up (n = 2), flat, down as 1/f: mean squares by hand.
    const PowerSpectrum spectrum =
        parsePowerSpectrum("frequency [Hz],psd [(m/s^2)^2/Hz]\n# comment\n10,0.1\n20;0.4\n40\t0.4\n80 0.2\n", "s.csv");
    CHECK(spectrum.calcValue(15) == Approx(0.1 * 2.25));
    CHECK(spectrum.calcValue(30) == Approx(0.4));
    CHECK(spectrum.calcValue(60) == Approx(0.4 * 40 / 60));
    CHECK(spectrum.calcValue(9.99) == 0);
    CHECK(spectrum.calcValue(80.01) == 0);
    const double square = 0.1 / 100 * (8000 - 1000) / 3 + 0.4 * 20 + 0.4 * 40 * std::log(2.0);
    CHECK(spectrum.calcMeanSquare(10, 80) == Approx(square).epsilon(1e-12));
    CHECK(spectrum.calcMeanSquare(0, 15) == Approx(0.001 * (3375 - 1000) / 3).epsilon(1e-12));
    CHECK(parsePowerSpectrum("20,0.01\n2000,0.01\n", "s.csv").calcRms() ==
          Approx(9.80665 * std::sqrt(0.01 * 1980)).epsilon(1e-12));
    CHECK(parsePowerSpectrum("f [Hz],S [N²/Hz]\n1,2\n2,2", "s.csv").quantity() == Quantity::force);
    for (const char* bad : {"", "20,0.01\n", "20,0.01\n20,0.01\n", "20,0.01\n30,0\n", "20,0.01\n30,x\n",
                            "f [kHz],S\n20,1\n30,1\n", "f [Hz],S [g]\n20,1\n30,1\n", "-1,1\n2,1\n", "1,nan\n2,1\n"}) {
        CAPTURE(bad);
        CHECK_THROWS_AS(parsePowerSpectrum(bad, "s.csv"), InputError);
    }
}
