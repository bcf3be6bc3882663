// The force curve: against values by hand and by another program, and its derivatives and work.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "models/axis_law.hpp"
#include "models/force_curve.hpp"
#include "models/law_equality.hpp"
#include "tests/models/random_values.hpp"
#include "tests/seed.hpp"

namespace wems {
namespace {

// Of a rubber buffer: softer in tension than in compression.
const std::vector<CurveRow> kBuffer = {
    {-2e-3, -260, {}}, {-1e-3, -90, {}}, {0, 0, {}}, {1e-3, 60, {}}, {3e-3, 150, {}}};

}  // namespace

TEST_CASE("A force curve passes through its rows, and a spring's rows give the spring") {
    const ForceCurve buffer(kBuffer);
    for (const CurveRow& row : kBuffer) CHECK(buffer.calcForce(row.displacement) == Approx(row.force).margin(1e-12));
    const ForceCurve spring({{-1e-3, -20, {}}, {0, 0, {}}, {5e-4, 10, {}}, {4e-3, 80, {}}});
    for (const double q : {-3e-3, -4e-4, 1e-4, 2e-3, 7e-3}) {
        CHECK(spring.calcForce(q) == Approx(2e4 * q).epsilon(1e-12));
        CHECK(spring.calcStiffness(q) == Approx(2e4).epsilon(1e-12));
        CHECK(spring.calcPotential(q) == Approx(1e4 * q * q).epsilon(1e-12));
    }
}

TEST_CASE("A force curve between its rows is that of SciPy's PCHIP") {
    // scipy.interpolate.PchipInterpolator on the same rows, SciPy 1.17.
    const ForceCurve buffer(kBuffer);
    CHECK(buffer.calcForce(-1.7e-3) == Approx(-199.824615385));
    CHECK(buffer.calcForce(-0.4e-3) == Approx(-30.7495384615));
    CHECK(buffer.calcForce(0.3e-3) == Approx(20.2517419355));
    CHECK(buffer.calcForce(1.5e-3) == Approx(85.4788306452));
    CHECK(buffer.calcForce(2.9e-3) == Approx(146.436975806));
}

TEST_CASE("Rows with slopes of a cubic are that cubic, as a law of its own") {
    AxisLaw cubic, rows;
    cubic.stiffness = 2e4;
    cubic.cubic = 5e9;
    cubic.quadratic = -3e6;
    const AxisForce expected(cubic);
    for (const double q : {-2e-3, -5e-4, 0.0, 1e-3, 3e-3})
        rows.curve.push_back({q, expected.calcStaticForce(q), expected.calcStaticStiffness(q)});
    const AxisForce curve(rows);
    for (double q = -2e-3; q < 3e-3; q += 0.13e-3) {
        CHECK(curve.calcForce(q, 0, 0, nullptr) == Approx(expected.calcForce(q, 0, 0, nullptr)).epsilon(1e-10));
        CHECK(curve.calcStiffness(q, 0, 0, nullptr) == Approx(expected.calcStiffness(q, 0, 0, nullptr)).epsilon(1e-10));
        CHECK(curve.calcPotential(q, 0, nullptr) == Approx(expected.calcPotential(q, 0, nullptr)).epsilon(1e-10));
    }
}

TEST_CASE("A force curve rises and falls with its rows alone") {
    std::mt19937_64 random(test::drawSeed());
    std::uniform_real_distribution<double> step(1e-4, 1e-3), rise(0, 50);
    for (int trial = 0; trial < 50; ++trial) {
        std::vector<CurveRow> rows{{0, 0, {}}};
        for (int i = 0; i < 6; ++i)
            rows.push_back({rows.back().displacement + step(random), rows.back().force + rise(random) * (i % 3), {}});
        const ForceCurve curve(rows);
        double before = curve.calcForce(-1e-3);
        for (double q = -1e-3; q < rows.back().displacement + 1e-3; q += 1e-6) {
            const double force = curve.calcForce(q);
            REQUIRE(force >= before - 1e-12);
            before = force;
        }
    }
}

TEST_CASE("Slope and work of a force curve are those of its force, at each row from both sides") {
    test::RandomValues random(test::drawSeed());
    for (int trial = 0; trial < 50; ++trial) {
        const std::vector<CurveRow> rows = random.curve();
        const ForceCurve curve(rows);
        const double reach = 1.5e-3 + rows.back().displacement - rows.front().displacement;
        double steepest = 0;
        for (double q = -reach; q < reach; q += 0.037e-3) {
            constexpr double h = 1e-9;
            CAPTURE(q);
            CHECK(curve.calcStiffness(q) ==
                  Approx((curve.calcForce(q + h) - curve.calcForce(q - h)) / (2 * h)).margin(1));
            CHECK(curve.calcForce(q) ==
                  Approx((curve.calcPotential(q + h) - curve.calcPotential(q - h)) / (2 * h)).margin(1e-3));
            steepest = std::max(steepest, curve.calcStiffness(q));
        }
        CHECK(curve.largestStiffness() >= steepest * (1 - 1e-12));
        CHECK(curve.calcPotential(0) == 0);
    }
}

TEST_CASE("The slope at rest moves to the stiffness without a change of the force") {
    AxisLaw law;
    law.stiffness = 1000;
    law.curve = kBuffer;
    const AxisForce before(law);
    moveSlopeToStiffness(law);
    const AxisForce after(law);
    CHECK(law.stiffness == Approx(before.calcStaticStiffness(0)));
    CHECK(after.curve().calcStiffness(0) == Approx(0).margin(1e-9));
    for (double q = -4e-3; q < 5e-3; q += 0.1e-3) {
        CHECK(after.calcStaticForce(q) == Approx(before.calcStaticForce(q)).epsilon(1e-10).margin(1e-10));
        CHECK(after.calcForce(q, 0, 0, nullptr) == Approx(after.calcStaticForce(q)).epsilon(1e-10).margin(1e-9));
    }
    // A curve without stiffness at rest, such as a gap, stays as it is.
    AxisLaw gap;
    gap.curve = {{-1e-3, 0, {}}, {0, 0, {}}, {1e-3, 0, {}}, {2e-3, 100, {}}};
    const AxisLaw same = gap;
    moveSlopeToStiffness(gap);
    CHECK(gap == same);
}

TEST_CASE("Rows that are no curve are named") {
    const auto refused = [](const std::vector<CurveRow>& rows) {
        const auto problem = findProblem(rows);
        return problem ? std::to_string(problem->row) + " " + problem->problem : std::string();
    };
    CHECK(refused(kBuffer).empty());
    CHECK(refused({{0, 0, {}}}) == "-1 has 1 rows");
    CHECK(refused({{0, 0, {}}, {0, 1, {}}}) == "1 has the displacement 0");
    CHECK(refused({{-1, -1, {}}, {1, 1, {}}}) == "-1 does not pass through rest");
    CHECK(refused({{0, 0, {}}, {1, std::nan(""), {}}}) == "1 holds no finite numbers");
    CHECK(refused({{0, 0, {}}, {1e-150, 1, {}}}) == "1 is too near to the row before");
}

}  // namespace wems
