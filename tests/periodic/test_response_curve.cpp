// Response curves: linear, Duffing against its algebra, a one-sided stop against time integration.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "models/common/error.hpp"
#include "models/common/units.hpp"
#include "models/periodic/response_curve.hpp"
#include "tests/models/oscillator.hpp"
#include "tests/plugin/sample_models.hpp"

using namespace wems;

namespace {

constexpr double kMass = 2, kStiffness = 2e4, kDamping = 8;

/// Values of A = a² with [(k − mω² + ¾ k_c A)² + (cω)²] A = F²: roots of a cubic, by bisection between its turning
/// points.
std::vector<double> solveDuffing(double omega, double cubic, double force) {
    const double detuning = kStiffness - kMass * omega * omega, b = 0.75 * cubic, c = kDamping * omega;
    const auto p = [&](double A) { return ((detuning + b * A) * (detuning + b * A) + c * c) * A - force * force; };
    // p' = 3 b² A² + 4 b δ A + δ² + c²
    std::vector<double> ends{0};
    const double root = 4 * b * b * detuning * detuning - 3 * b * b * (detuning * detuning + c * c);
    if (root > 0)
        for (const double sign : {-1.0, 1.0}) {
            const double A = (-2 * b * detuning + sign * std::sqrt(root)) / (3 * b * b);
            if (A > 0) ends.push_back(A);
        }
    ends.push_back(std::max(1.0, 10 * ends.back()));
    std::vector<double> roots;
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
        double low = ends[i], high = ends[i + 1];
        if (p(low) * p(high) > 0) continue;
        for (int k = 0; k < 200; ++k) {
            const double middle = 0.5 * (low + high);
            (p(low) * p(middle) <= 0 ? high : low) = middle;
        }
        roots.push_back(low);
    }
    return roots;
}

/// A mass on spring, dashpot and one stop on a base that shakes: classical Runge–Kutta from rest, settled.
struct Stopped {
    double damping, acceleration, clearance, stop, offset;

    /// Highest and lowest q of each of the last four periods.
    std::vector<std::pair<double, double>> integrate(double f) const {
        const int per_period = 2000, settle = 200, look = 4;
        const double h = 1 / (f * per_period), omega = kTwoPi * f;
        const auto slope = [&](double t, double q, double v) {
            const double contact = stop * std::max(0.0, q + offset - clearance);
            return (-kStiffness * q - damping * v - contact) / kMass - acceleration * std::cos(omega * t);
        };
        double q = 0, v = 0;
        std::vector<std::pair<double, double>> ends(look, {-1e9, 1e9});
        for (int k = 0; k < (settle + look) * per_period; ++k) {
            const double t = k * h;
            const double k1 = slope(t, q, v), v2 = v + h / 2 * k1;
            const double k2 = slope(t + h / 2, q + h / 2 * v, v2), v3 = v + h / 2 * k2;
            const double k3 = slope(t + h / 2, q + h / 2 * v2, v3), v4 = v + h * k3;
            const double k4 = slope(t + h, q + h * v3, v4);
            q += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
            v += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
            if (k < settle * per_period) continue;
            auto& [highest, lowest] = ends[std::size_t(k / per_period - settle)];
            highest = std::max(highest, q);
            lowest = std::min(lowest, q);
        }
        return ends;
    }
};

MountModel makeStopped(const Stopped& stopped) {
    MountModel model = test::makeOscillator(kMass, kStiffness, stopped.damping);
    AxisLaw& law = model.connections[0].axis[2];
    law.stops.push_back({Side::positive, stopped.clearance, stopped.stop, 0});
    law.offset = stopped.offset;
    return model;
}

/// Amplitude along z by straight lines between neighbouring stable points.
std::vector<double> findStable(const ResponseCurve& curve, double f) {
    std::vector<double> found;
    for (std::size_t i = 1; i < curve.points.size(); ++i) {
        const ResponsePoint &a = curve.points[i - 1], &b = curve.points[i];
        if ((a.frequency - f) * (b.frequency - f) > 0 || a.instability != Instability::none) continue;
        const double u = (f - a.frequency) / (b.frequency - a.frequency);
        found.push_back((1 - u) * a.amplitude[2] + u * b.amplitude[2]);
    }
    return found;
}

}  // namespace

TEST_CASE("a linear device: the curve is its transfer function, all of it stable, no fold") {
    MountModel model = test::withBracket(test::makeRigidModel());
    for (Connection& connection : model.connections)
        for (AxisLaw& law : connection.axis) {
            law.damping = 20;
            law.loss_factor = 0.1;
        }
    const HarmonicInput input{{3, 0, 10}, Eigen::Vector3d::Zero()};
    const ResponseCurve curve = calcResponseCurve(model, input, {5, 60, 3, true, {}});
    CHECK(curve.incomplete.empty());
    CHECK(curve.folds.empty());
    CHECK(curve.points.size() > 100);
    const LinearDynamics dynamics(model);
    for (const ResponsePoint& point : curve.points) {
        const auto response = dynamics.calcResponse(point.frequency, input);
        for (Eigen::Index i = 0; i < 3; ++i)
            CHECK((point.first.segment<3>(3 * i) - response[std::size_t(i)].relative.cwiseAbs()).norm() <
                  1e-6 * point.first.norm());
        CHECK(point.instability == Instability::none);
    }
}

TEST_CASE("straight lines between the points keep to the curve, at resonances and antiresonances") {
    MountModel model = test::withBracket(test::makeRigidModel());
    for (Connection& connection : model.connections)
        for (AxisLaw& law : connection.axis) {
            law.damping = 5;
            law.stops = {{Side::positive, 1, 1e5, 0}};  // out of reach
        }
    const HarmonicInput input{{3, 0, 10}, Eigen::Vector3d::Zero()};
    const ResponseCurve curve = calcResponseCurve(model, input, {5, 60, 3, false, {}});
    const LinearDynamics dynamics(model);
    const auto amplitudesAt = [&](double f) {
        Eigen::VectorXd all(3 * model.connections.size());
        const auto response = dynamics.calcResponse(f, input);
        for (Eigen::Index i = 0; 3 * i < all.size(); ++i)
            all.segment<3>(3 * i) = response[std::size_t(i)].relative.cwiseAbs();
        return all;
    };
    // Twice the 2e-3 of the amplitude, or 4e-4 of the frequency, that two tangents foretell.
    constexpr double part = 4e-3, shift = 4e-4;
    double largest = 0;
    for (std::size_t k = 1; k < curve.points.size(); ++k) {
        const ResponsePoint &a = curve.points[k - 1], &b = curve.points[k];
        const double f = 0.5 * (a.frequency + b.frequency);
        const Eigen::VectorXd exact = amplitudesAt(f), before = amplitudesAt(f * (1 - shift)),
                              after = amplitudesAt(f * (1 + shift));
        for (Eigen::Index i = 0; i < exact.size(); ++i) {
            const double off = std::abs(0.5 * (a.amplitude[i] + b.amplitude[i]) - exact[i]);
            const double allowed =
                part * std::max(exact[i], 0.01 * exact.maxCoeff()) + 0.5 * std::abs(after[i] - before[i]);
            largest = std::max(largest, off / allowed);
        }
    }
    CHECK(largest < 1);
}

TEST_CASE("Duffing with one harmonic: amplitudes and folds are those of its algebra") {
    MountModel model = test::makeOscillator(kMass, kStiffness, kDamping);
    const double cubic = GENERATE(4e7, -9e7);
    model.connections[0].axis[2].cubic = cubic;
    const double force = cubic > 0 ? 12 : 5;
    const ResponseCurve curve = calcResponseCurve(model, test::driveBy(force, kMass), {10, 30, 1, true, {}});
    CAPTURE(cubic, curve.incomplete);
    REQUIRE(curve.incomplete.empty());
    for (const ResponsePoint& point : curve.points) {
        const double a = point.first[2], omega = kTwoPi * point.frequency;
        const double stiff = (kStiffness - kMass * omega * omega) * a + 0.75 * cubic * a * a * a;
        CHECK(std::hypot(stiff, kDamping * omega * a) == Approx(force).epsilon(1e-5));
    }
    // Folds: where the number of solutions changes.
    std::vector<double> folds;
    std::size_t last = solveDuffing(kTwoPi * 10, cubic, force).size();
    for (double f = 10; f < 30; f += 0.01) {
        if (solveDuffing(kTwoPi * (f + 0.01), cubic, force).size() == last) continue;
        double low = f, high = f + 0.01;
        for (int k = 0; k < 60; ++k) {
            const double middle = 0.5 * (low + high);
            (solveDuffing(kTwoPi * middle, cubic, force).size() == last ? low : high) = middle;
        }
        folds.push_back(low);
        last = solveDuffing(kTwoPi * (f + 0.01), cubic, force).size();
    }
    REQUIRE(folds.size() == 2);
    REQUIRE(curve.folds.size() == 2);
    std::vector<double> found{curve.folds[0].frequency, curve.folds[1].frequency};
    std::sort(found.begin(), found.end());
    CHECK(found[0] == Approx(folds[0]).margin(0.005));
    CHECK(found[1] == Approx(folds[1]).margin(0.005));
    // Between the folds, on the way back, unstable by a real multiplier; elsewhere stable.
    for (std::size_t i = 1; i + 1 < curve.points.size(); ++i) {
        const bool back = curve.points[i + 1].frequency < curve.points[i].frequency &&
                          curve.points[i].frequency < curve.points[i - 1].frequency;
        const bool forward = curve.points[i + 1].frequency > curve.points[i].frequency &&
                             curve.points[i].frequency > curve.points[i - 1].frequency;
        CAPTURE(curve.points[i].frequency, curve.points[i].largest_multiplier);
        // At a fold the multiplier is 1. That of all harmonics, which the multipliers see, lies beside that of one: the
        // multiplier of the upper one passes 1 some 0.012 Hz below it.
        const double f = curve.points[i].frequency;
        if (std::abs(f - folds[0]) < 0.02 || std::abs(f - folds[1]) < 0.02) continue;
        if (back) CHECK(curve.points[i].instability == Instability::real);
        if (forward) CHECK(curve.points[i].instability == Instability::none);
    }
}

TEST_CASE("a one-sided stop: stable amplitudes are those of time integration, contact is told") {
    const Stopped stopped{30, 5, 1e-3, 1e5, 2e-4};
    const ResponseCurve curve =
        calcResponseCurve(makeStopped(stopped), test::driveBy(5 * kMass, kMass), {8, 30, 20, true, {}});
    CAPTURE(curve.incomplete);
    REQUIRE(curve.incomplete.empty());
    CHECK(curve.folds.size() == 2);
    int touched = 0;
    for (const double f : {9.0, 12.0, 14.5, 17.0, 19.0, 20.5, 22.0, 28.0}) {
        const auto [highest, lowest] = stopped.integrate(f).back();
        const double expected = 0.5 * (highest - lowest);
        const std::vector<double> stable = findStable(curve, f);
        CAPTURE(f, expected, stable);
        REQUIRE_FALSE(stable.empty());
        double nearest = 1e9;
        for (const double amplitude : stable)
            if (std::abs(amplitude - expected) < std::abs(nearest - expected)) nearest = amplitude;
        CHECK(nearest == Approx(expected).epsilon(5e-3));
        touched += highest + stopped.offset > stopped.clearance;
    }
    CHECK(touched > 1);
    for (const ResponsePoint& point : curve.points) {
        CHECK(point.touchesStop() == (point.highest[2] + stopped.offset > stopped.clearance));
        CHECK(point.penetration.size() == 1);
    }
}

TEST_CASE("with little damping a stop doubles the period, where the multipliers say so") {
    const Stopped stopped{8, 5, 1e-3, 1e5, 2e-4};
    const ResponseCurve curve =
        calcResponseCurve(makeStopped(stopped), test::driveBy(5 * kMass, kMass), {11, 15, 20, true, {}});
    const auto doubled = [&](double f) {
        bool found = false;
        for (std::size_t i = 1; i < curve.points.size(); ++i)
            if ((curve.points[i - 1].frequency - f) * (curve.points[i].frequency - f) <= 0)
                found = curve.points[i].instability == Instability::period_doubling;
        return found;
    };
    const double f = 12.6;
    const auto ends = stopped.integrate(f);
    const double one = std::abs(ends[3].first - ends[2].first), two = std::abs(ends[3].first - ends[1].first);
    CAPTURE(one, two);
    CHECK(doubled(f));
    CHECK_FALSE(doubled(11.2));
    CHECK(one > 0.01 * ends[3].first);
    CHECK(two < 1e-3 * one);
}

TEST_CASE("what a response curve cannot be made of is refused") {
    MountModel model = test::makeOscillator(kMass, kStiffness, kDamping);
    CHECK_THROWS_AS(calcResponseCurve(model, {{0, 0, 1}, Eigen::Vector3d::Zero()}, {5, 50, 5, true, {}}), InputError);
    CHECK_THROWS_AS(calcResponseCurve(model, test::driveBy(1, 1), {50, 5, 5, true, {}}), InputError);
    CHECK_THROWS_AS(calcResponseCurve(model, test::driveBy(1, 1), {5, 50, 0, true, {}}), InputError);
    model.connections[0].axis[0].friction = Friction{1, 1e-3, 1e5};
    CHECK_THROWS_AS(calcResponseCurve(model, test::driveBy(1, 1), {5, 50, 5, true, {}}), InputError);
    model.connections[0].axis[0].friction.reset();
    model.connections[0].axis[0].hysteresis = Hysteresis{1, 1e-4, 1, 0.5};
    CHECK_THROWS_WITH(calcResponseCurve(model, test::driveBy(1, 1), {5, 50, 5, true, {}}),
                      Catch::Contains("connection[0].x.hysteresis"));
}
