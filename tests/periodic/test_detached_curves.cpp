// A linear structure with a nonlinear absorber: its detached resonance against the algebra of one harmonic.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>

#include "models/common/units.hpp"
#include "models/periodic/response_curve.hpp"
#include "tests/models/oscillator.hpp"

using namespace wems;

namespace {

/// A mode of modal mass 1 kg, forced, with an absorber on a cubic spring.
struct Absorber {
    double mode_frequency = 20, mode_damping_ratio = 0.002, mass = 0.05;
    double stiffness = 0.3 * mass * std::pow(kTwoPi * mode_frequency, 2);
    double damping = 0.2 * mass * kTwoPi * mode_frequency, cubic = 4e8 * mass, force = 4;

    MountModel makeModel() const {
        MountModel model = test::makeOscillator(mass, stiffness, damping);
        model.connections[0].axis[2].cubic = cubic;
        BracketMode mode;
        mode.frequency = mode_frequency;
        mode.damping_ratio = mode_damping_ratio;
        mode.translation = mode.load_translation = Eigen::Vector3d::UnitZ();
        model.bracket = {mode};
        return model;
    }

    /// Amplitudes |Q| of the absorber's relative motion, ascending: |a + e s|² s = |m ω² H F|² for s = |Q|², the
    /// positive roots of a cubic as eigenvalues of its companion matrix.
    std::vector<double> solve(double f) const {
        using Complex = std::complex<double>;
        const double w = kTwoPi * f, w0 = kTwoPi * mode_frequency;
        const Complex H = 1.0 / Complex(w0 * w0 - w * w, 2 * mode_damping_ratio * w0 * w);
        const Complex b = 1.0 - mass * w * w * H, a = Complex(stiffness, w * damping) * b - mass * w * w;
        const Complex e = 0.75 * cubic * b;
        // In units of (10 mm)², so that the matrix holds numbers of one size.
        constexpr double unit = 1e-4;
        const double lead = std::norm(e * unit);
        Eigen::Matrix3d companion;
        companion << 0, 0, std::norm(mass * w * w * H * force) / (lead * unit), 1, 0, -std::norm(a) / lead, 0, 1,
            -2 * (a * std::conj(e)).real() * unit / lead;
        std::vector<double> amplitudes;
        const Eigen::Vector3cd squares = companion.eigenvalues();
        for (const Complex& s : squares)
            if (s.real() > 0 && std::abs(s.imag()) < 1e-9 * std::abs(s))
                amplitudes.push_back(std::sqrt(unit * s.real()));
        std::sort(amplitudes.begin(), amplitudes.end());
        return amplitudes;
    }
};

}  // namespace

// One harmonic has three solutions in two bands: between 17.5 and 19.4 Hz the upper two are a curve of their own,
// between 21.5 and 21.8 Hz the curve from the low end folds.
TEST_CASE("a detached resonance is found, closed, and as the algebra of one harmonic has it") {
    const Absorber absorber;
    // Where the number of solutions changes, by bisection between one frequency with three and one with one.
    const auto findEnd = [&](double three, double one) {
        REQUIRE(absorber.solve(three).size() == 3);
        REQUIRE(absorber.solve(one).size() == 1);
        for (int k = 0; k < 60; ++k) {
            const double middle = 0.5 * (three + one);
            (absorber.solve(middle).size() == 3 ? three : one) = middle;
        }
        return three;
    };
    const auto sorted = [](const std::vector<ResponseFold>& folds) {
        std::vector<double> frequencies;
        for (const auto& fold : folds) frequencies.push_back(fold.frequency);
        std::sort(frequencies.begin(), frequencies.end());
        return frequencies;
    };
    const ResponseCurve curve = calcResponseCurve(
        absorber.makeModel(), {{0, 0, absorber.force}, Eigen::Vector3d::Zero()}, {15, 25, 1, true, {}});
    REQUIRE(curve.incomplete.empty());
    const std::vector<double> folds = sorted(curve.folds);
    REQUIRE(folds.size() == 2);
    CHECK(folds[0] == Approx(findEnd(21.6, 21)).margin(0.01));
    CHECK(folds[1] == Approx(findEnd(21.6, 22)).margin(0.01));
    const auto checkSolution = [&](const ResponsePoint& point) {
        double nearest = INFINITY;
        for (const double amplitude : absorber.solve(point.frequency))
            nearest = std::min(nearest, std::abs(point.first[2] / amplitude - 1));
        CAPTURE(point.frequency, point.first[2]);
        CHECK(nearest < 1e-5);
    };
    for (const ResponsePoint& point : curve.points) {
        checkSolution(point);
        if (point.frequency > 20) continue;
        CAPTURE(point.frequency);
        CHECK(point.first[2] == Approx(absorber.solve(point.frequency).front()).epsilon(1e-5));
    }
    REQUIRE(curve.detached.size() == 1);
    const ResponseCurve& apart = curve.detached.front();
    CHECK(apart.incomplete.empty());
    REQUIRE(apart.points.size() > 50);
    CHECK(apart.points.front().frequency == Approx(apart.points.back().frequency));  // it comes back to its start
    for (const ResponsePoint& point : apart.points) {
        checkSolution(point);
        CHECK(point.first[2] > 1.01 * absorber.solve(point.frequency).front());
    }
    const std::vector<double> ends = sorted(apart.folds);
    REQUIRE(ends.size() == 2);
    CHECK(ends[0] == Approx(findEnd(18.5, 15)).margin(0.01));
    CHECK(ends[1] == Approx(findEnd(18.5, 20)).margin(0.01));
}

TEST_CASE("no detached resonance where there is none, and none looked for where not asked") {
    Absorber absorber;
    ResponseSettings settings{15, 25, 1, false, {}};
    settings.detached = false;
    const HarmonicInput input{{0, 0, absorber.force}, Eigen::Vector3d::Zero()};
    CHECK(calcResponseCurve(absorber.makeModel(), input, settings).detached.empty());
    settings.detached = true;
    absorber.force = 0.2;
    for (double f = 15; f < 25; f += 0.01) REQUIRE(absorber.solve(f).size() == 1);
    CHECK(calcResponseCurve(absorber.makeModel(), {{0, 0, absorber.force}, Eigen::Vector3d::Zero()}, settings)
              .detached.empty());
}

TEST_CASE("a band that begins where a stop is touched already") {
    MountModel model = test::makeOscillator(2, 2e4, 60);
    model.connections[0].axis[2].stops = {{Side::positive, 1e-3, 1e5, 0}, {Side::negative, 2e-3, 1e5, 0}};
    // The same motion at 13 Hz, wherever the band begins; 200 N would press the elastomer alone by 10 mm.
    const auto findAmplitude = [&](double from) {
        const ResponseCurve curve = calcResponseCurve(model, test::driveBy(200, 2), {from, 14, 15, false, {}});
        REQUIRE(curve.incomplete.empty());
        for (std::size_t i = 1; i < curve.points.size(); ++i) {
            const ResponsePoint &a = curve.points[i - 1], &b = curve.points[i];
            if (a.frequency > 13 || b.frequency < 13) continue;
            return a.amplitude[2] +
                   (13 - a.frequency) / (b.frequency - a.frequency) * (b.amplitude[2] - a.amplitude[2]);
        }
        return 0.0;
    };
    CHECK(findAmplitude(9) == Approx(findAmplitude(2)).epsilon(1e-3));
}

TEST_CASE("where stability changes is told with its kind") {
    MountModel model = test::makeOscillator(2, 2e4, 8);
    model.connections[0].axis[2].cubic = 4e7;
    const ResponseCurve curve = calcResponseCurve(model, test::driveBy(12, 2), {10, 30, 3, true, {}});
    REQUIRE(curve.folds.size() == 2);
    REQUIRE(curve.bifurcations.size() == 2);
    for (std::size_t i = 0; i < 2; ++i) {
        CHECK(curve.bifurcations[i].kind == Instability::real);
        CHECK(curve.bifurcations[i].frequency == Approx(curve.folds[i].frequency).margin(0.01));
    }
}
