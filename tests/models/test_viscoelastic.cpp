// Data sheets and spring-pots as series of passive branches, beside the complex stiffness that they were made of.
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <random>

#include "models/common/units.hpp"
#include "models/linear_response.hpp"
#include "models/mount_model.hpp"
#include "models/viscoelastic.hpp"
#include "tests/seed.hpp"

using namespace wems;

namespace {

using Complex = std::complex<double>;

double drawBetween(std::mt19937& random, double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
}

/// Of the law as everything evaluates it: its branches, static stiffness and dashpot.
Complex calcStiffness(const AxisLaw& law, double frequency) {
    const AxisForce force(law);
    const double omega = kTwoPi * frequency;
    Complex sum(force.calcStaticStiffness(0), omega * law.damping);
    for (const MaxwellBranch& branch : force.branches()) {
        const Complex turn(0, omega * branch.time_constant);
        sum += branch.stiffness * turn / (1.0 + turn);
    }
    return sum;
}

/// One body of 2 kg on one axis that a file describes.
MountModel readOneAxis(const std::string& axis) {
    return parseMountModel(
        "[body]\nmass = 2.0\ninertia = [0.01, 0.01, 0.01]\nmotion = [\"z\"]\n"
        "[[connection]]\nname = \"1\"\nposition = [0.0, 0.0, 0.0]\n[connection.z]\n" +
            axis,
        "one.toml");
}

}  // namespace

TEST_CASE("a spring-pot: a power of the frequency over its band, by springs and dashpots that are passive") {
    const unsigned seed = test::drawSeed();
    std::mt19937 random(seed);
    for (int k = 0; k < 20; ++k) {
        SpringPot pot;
        pot.stiffness = std::pow(10, drawBetween(random, 3, 7));
        pot.exponent = drawBetween(random, 0.02, 0.95);
        pot.frequency = std::pow(10, drawBetween(random, -1, 3));
        pot.band.lower = std::pow(10, drawBetween(random, -3, 1));
        pot.band.upper = pot.band.lower * std::pow(10, drawBetween(random, 0.3, 6));
        const ViscoelasticSeries series = makeSeries(pot);
        CAPTURE(seed, k, pot.exponent, pot.band.lower, pot.band.upper);
        CHECK(series.stiffness >= 0);
        CHECK(series.damping >= 0);
        CHECK(series.branches.size() <= kMostBranches);
        for (const MaxwellBranch& branch : series.branches) CHECK(branch.stiffness > 0);
        for (int i = 0; i < 50; ++i) {
            const double f = pot.band.lower * std::pow(pot.band.upper / pot.band.lower, drawBetween(random, 0, 1));
            const Complex wanted =
                std::polar(pot.stiffness * std::pow(f / pot.frequency, pot.exponent), pot.exponent * kTwoPi / 4);
            CHECK(std::abs(series.complexStiffness(f) - wanted) < 6e-3 * std::abs(wanted));
        }
    }
}

TEST_CASE("a data sheet of an isolator from 1 to 2000 Hz is met within 3 %, with its reading errors") {
    const unsigned seed = test::drawSeed();
    std::mt19937 random(seed);
    for (int k = 0; k < 20; ++k) {
        // The fractional Zener model, which curves of rubbers follow; read to 1 % of the stiffness, 3 % of the loss.
        const double rubber = std::pow(10, drawBetween(random, 4, 6)), rise = drawBetween(random, 0.5, 20);
        const double exponent = drawBetween(random, 0.2, 0.8), middle = std::pow(10, drawBetween(random, 0, 4));
        const auto exact = [&](double f) {
            const Complex power = std::pow(Complex(0, f / middle), exponent);
            return rubber * (1.0 + rise * power / (1.0 + power));
        };
        std::vector<StiffnessRow> rows;
        for (const double f : {1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000}) {
            const Complex K = exact(f);
            rows.push_back({static_cast<double>(f), K.real() * (1 + drawBetween(random, -0.01, 0.01)),
                            K.imag() / K.real() * (1 + drawBetween(random, -0.03, 0.03))});
        }
        const ViscoelasticSeries series = fitSeries(rows);
        CAPTURE(seed, k, rise, exponent, middle, series.largest_error);
        for (int i = 0; i < 50; ++i) {
            const double f = std::pow(2000, drawBetween(random, 0, 1));
            CHECK(std::abs(series.complexStiffness(f) - exact(f)) < 0.03 * std::abs(exact(f)));
        }
    }
}

TEST_CASE("a model with a data sheet isolates as its complex stiffness says") {
    const auto stiffnessAt = [](double f) { return 8e4 + 3e4 * std::pow(Complex(0, f / 50), 0.4); };
    const std::vector<double> frequencies{5, 15, 50, 150, 500};
    std::string sheet;
    for (const double f : frequencies) {
        const Complex K = stiffnessAt(f);
        sheet += (sheet.empty() ? "[" : ", [") + std::to_string(f) + ", " + std::to_string(K.real()) + ", " +
                 std::to_string(K.imag() / K.real()) + "]";
    }
    const MountModel model = readOneAxis("data_sheet = [" + sheet + "]\n");
    const LinearDynamics dynamics(model);
    for (const double f : frequencies) {
        const Complex K = stiffnessAt(f);
        CHECK(std::abs(calcStiffness(model.connections[0].axis[2], f) - K) < 6e-3 * std::abs(K));
        // m q'' + K q = −m a
        const double omega = kTwoPi * f;
        const Complex expected = -2.0 / (K - 2.0 * omega * omega);
        const Complex relative = dynamics.calcResponse(f, {Eigen::Vector3d::Zero(), {0, 0, 1}})[0].relative[2];
        CAPTURE(f, relative, expected);
        CHECK(std::abs(relative - expected) < 2e-2 * std::abs(expected));
    }
}

TEST_CASE("a spring-pot stands beside the other numbers of an axis") {
    const std::string pot =
        "spring_pot = { stiffness = 1.0e4, exponent = 0.3, frequency = 10.0, band = [1.0, 100.0] }\n";
    const AxisLaw alone = readOneAxis(pot).connections[0].axis[2];
    const AxisLaw both = readOneAxis("stiffness = 5.0e4\ndamping = 20.0\n" + pot +
                                     "branches = [ { stiffness = 100.0, time_constant = 0.5 } ]\n")
                             .connections[0]
                             .axis[2];
    CHECK(both.stiffness == Approx(5e4 + alone.stiffness));
    CHECK(both.damping == Approx(20 + alone.damping));
    CHECK(both.branches.size() == 1);
    CHECK(both.spectrum.size() == alone.spectrum.size());
    const Complex other = Complex(5e4, kTwoPi * 10 * 20) + 100.0 * Complex(0, 1) / Complex(1 / (kTwoPi * 10 * 0.5), 1);
    CHECK(std::abs(calcStiffness(both, 10) - calcStiffness(alone, 10) - other) < 1);
    SECTION("its branches follow the stiffness") {
        AxisLaw softer = alone;
        softer.stiffness *= 0.8;
        softer.damping *= 0.8;
        CHECK(std::abs(calcStiffness(softer, 30) / calcStiffness(alone, 30) - 0.8) < 1e-12);
    }
    CHECK(std::abs(calcStiffness(alone, 10)) == Approx(1e4).epsilon(6e-3));
}
