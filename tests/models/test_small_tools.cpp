// Numbers and tables as text, names of parameters, spectra by breakpoints, structural branches, load points, sag.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>

#include "models/axis_law.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/common/text_table.hpp"
#include "models/common/units.hpp"
#include "models/hysteresis_terms.hpp"
#include "models/mount_forces.hpp"
#include "models/parameter_access.hpp"
#include "models/parameter_name.hpp"
#include "models/power_spectrum.hpp"
#include "models/report/html_text.hpp"
#include "models/static_equilibrium.hpp"
#include "tests/seed.hpp"

using namespace wems;
using Catch::Contains;

namespace {

MountModel makeSpring() {
    MountModel model;
    model.body.mass = 2;
    model.body.inertia = Eigen::Vector3d(0.1, 0.1, 0.1).asDiagonal();
    model.gravity = {0, 0, -10};
    model.connections.resize(1);
    model.connections[0].name = "a";
    for (AxisLaw& law : model.connections[0].axis) law.stiffness = 1e4;
    return model;
}

}  // namespace

TEST_CASE("formatNumber: shortest text that reads back, or so many digits") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    for (int i = 0; i < 2000; ++i) {
        double value = 0;
        const std::uint64_t bits = random();
        std::memcpy(&value, &bits, sizeof value);
        if (!std::isfinite(value)) continue;
        CHECK(std::strtod(formatNumber(value).c_str(), nullptr) == value);
    }
    CHECK(formatNumber(0.1) == "0.1");
    CHECK(formatNumber(1.0 / 3, 3) == "0.333");
    CHECK(formatNumber(std::nan("")) == "nan");
    CHECK(formatNumber(-std::numeric_limits<double>::infinity()) == "-inf");
    CHECK(joinWords({"a", "b", "c"}) == "a, b, c");
    CHECK(joinWords({}).empty());
    CHECK(joinWords({"a", "b"}, " + ") == "a + b");
}

TEST_CASE("splitCells: every cell, trimmed") {
    CHECK(splitCells(" a ,, b c\r", ',') == std::vector<std::string_view>{"a", "", "b c"});
    CHECK(splitCells("", ',') == std::vector<std::string_view>{""});
    CHECK(splitCells("\"a\";b;", ';', " \"") == std::vector<std::string_view>{"a", "b", ""});
    CHECK(trim(" \t ").empty());
    CHECK(trim("xxaxbxx", "x") == "axb");
}

TEST_CASE("table: first column to the left, others to the right, letters and not bytes counted") {
    Table table({"name", "value"});
    table.addRow({"µ", "1"});
    table.addRow({"longer", "-12.5"});
    CHECK(table.format() ==
          "name    value\n"
          "------  -----\n"
          "µ           1\n"
          "longer  -12.5\n");
}

TEST_CASE("names of parameters taken apart") {
    const MountModel model = makeSpring();
    using Kind = parameter::Target::Kind;
    CHECK(parameter::split("a.z.+.clearance") == std::vector<std::string>{"a", "z", "+", "clearance"});
    const auto axis = parameter::parse(model, "a.y.stiffness");
    CHECK(axis.kind == Kind::axis);
    CHECK(axis.index == 1);
    CHECK(axis.parameter == "stiffness");
    const auto stop = parameter::parse(model, "a.z.-.clearance");
    CHECK(stop.kind == Kind::stop);
    CHECK(stop.side == Side::negative);
    CHECK(parameter::parse(model, "body.mass").kind == Kind::mass);
    CHECK(parameter::parse(model, "body.center_of_gravity.z").index == 2);
    CHECK(parameter::parse(model, "load.gain").kind == Kind::load);
    CHECK(parameter::parse(model, "load.gain.y").index == 1);
    CHECK_THROWS_WITH(parameter::parse(model, "load.gain.w"), Catch::Contains("gain.x, gain.y and gain.z"));
    CHECK(parameter::parse(model, "mobile.a.az.gain").channel == "mobile.a.az");
    for (const char* wrong : {"b.x.stiffness", "a.w.stiffness", "body.colour", "7.frequency", "", "..."})
        CHECK_THROWS_AS(parameter::parse(model, wrong), InputError);
    CHECK_THROWS_AS(getParameter(model, "a.x.colour"), InputError);
    // A stop that is new: ten times the elastomer where the model has none.
    CHECK(parameter::newStopStiffness(model, stop) == 1e5);
    CHECK(parameter::typicalClearance(model) == 1e-3);
    MountModel other = model;
    other.connections[0].axis[2].stops = {{Side::positive, 2e-3, 7e5, 0}};
    CHECK(parameter::newStopStiffness(other, stop) == 7e5);
    CHECK(parameter::typicalClearance(other) == Approx(2e-3));
}

TEST_CASE("power spectrum: straight lines in log-log, mean squares against a fine sum") {
    const PowerSpectrum spectrum({10, 20, 100, 400}, {1, 4, 4, 0.25}, Quantity::acceleration);
    CHECK(spectrum.calcValue(10) == Approx(1));
    CHECK(spectrum.calcValue(std::sqrt(200.0)) == Approx(2));  // half-way in log f: geometric mean
    CHECK(spectrum.calcValue(50) == Approx(4));
    CHECK(spectrum.calcValue(200) == Approx(1));
    CHECK(spectrum.calcValue(9.99) == 0);
    CHECK(spectrum.calcValue(401) == 0);
    const auto sum = [&](double from, double to) {  // midpoints
        const int pieces = 200000;
        double total = 0;
        for (int i = 0; i < pieces; ++i) total += spectrum.calcValue(from + (to - from) * (i + 0.5) / pieces);
        return total * (to - from) / pieces;
    };
    for (const auto& [from, to] :
         {std::pair(10.0, 400.0), std::pair(12.0, 15.0), std::pair(15.0, 120.0), std::pair(30.0, 31.0)})
        CHECK(spectrum.calcMeanSquare(from, to) == Approx(sum(from, to)).epsilon(1e-6));
    CHECK(spectrum.calcMeanSquare(0, 1e4) == Approx(spectrum.calcMeanSquare(10, 400)));
    CHECK(spectrum.calcRms() == Approx(std::sqrt(spectrum.calcMeanSquare(10, 400))));
    // Falling as 1/f: ∫ = S₀ f₀ ln(f₁/f₀), where the power law's own integral has no value.
    const PowerSpectrum pink({10, 1000}, {1, 0.01}, Quantity::force);
    CHECK(pink.calcMeanSquare(10, 1000) == Approx(10 * std::log(100.0)));
    CHECK_THROWS_AS(PowerSpectrum({10, 10}, {1, 1}, Quantity::force), InputError);
    CHECK_THROWS_AS(PowerSpectrum({10, 20}, {1, 0}, Quantity::force), InputError);
    CHECK_THROWS_AS(PowerSpectrum({10}, {1}, Quantity::force), InputError);
    const PowerSpectrum read =
        parsePowerSpectrum("# test\nfrequency [Hz];psd [g^2/Hz]\n20;0.01\n200;0.02\n", "test.csv");
    CHECK(read.calcValue(20) == Approx(0.01 * 9.80665 * 9.80665));
    CHECK_THROWS_WITH(parsePowerSpectrum("20,0.01\n10,0.01\n", "test.csv"), Contains("test.csv"));
}

TEST_CASE("structural branches: a loss modulus of one over a decade, within what the header says") {
    const StructuralBranches& all = structuralBranches();
    // Corner frequencies f_m/κ, f_m, κ f_m tell the middle of the band.
    const double middle = 1 / all.branch[1].time_constant;
    double storage = 0;
    for (int i = -10; i <= 10; ++i) {
        const double w = middle * std::pow(10.0, 0.05 * i);
        double loss = 0;
        for (const MaxwellBranch& branch : all.branch) {
            const double u = w * branch.time_constant;
            loss += branch.stiffness * u / (1 + u * u);
            if (i == 0) storage += branch.stiffness * u * u / (1 + u * u);
        }
        CAPTURE(i, loss);
        CHECK(loss == Approx(1).epsilon(2.1e-3));
    }
    CHECK(all.storage_in_middle == Approx(storage));
}

TEST_CASE("load point: force and moment on the part that it acts on, what is left for the bracket") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<> normal;
    const auto draw = [&] { return Eigen::Vector3d(normal(random), normal(random), normal(random)); };
    BodyMotion mobile;
    mobile.R_GM = Eigen::AngleAxisd(0.7, draw().normalized()).toRotationMatrix();
    const FrameMotion fixed;
    const Eigen::Vector3d load = draw(), position = draw();
    for (const Part part : {Part::mobile, Part::fixed}) {
        LoadPoint point;
        point.part = part;
        point.position = position;
        Wrench on_mobile, on_fixed;
        CHECK(applyLoad(point, mobile, fixed, load, on_mobile, on_fixed).isZero());
        const bool to_mobile = part == Part::mobile;
        const Wrench &loaded = to_mobile ? on_mobile : on_fixed, &other = to_mobile ? on_fixed : on_mobile;
        const Eigen::Vector3d arm = to_mobile ? Eigen::Vector3d(mobile.R_GM * position) : position;
        CHECK((loaded.force - load).norm() < 1e-15);
        CHECK(loaded.moment.x() == Approx(arm.y() * load.z() - arm.z() * load.y()));
        CHECK(loaded.moment.z() == Approx(arm.x() * load.y() - arm.y() * load.x()));
        CHECK(other.force.isZero());
        CHECK(other.moment.isZero());
    }
    Wrench on_mobile, on_fixed;
    CHECK(applyLoad(std::nullopt, mobile, fixed, load, on_mobile, on_fixed) == load);
    CHECK(on_mobile.force.isZero());
    MountModel model = makeSpring();
    CHECK_FALSE(loadActs(model));
    model.bracket.resize(1);
    CHECK(loadActs(model));
}

TEST_CASE("static sag of a spring: m g / k, and what is left of each clearance") {
    MountModel model = makeSpring();
    AxisLaw& law = model.connections[0].axis[2];
    law.stops = {{Side::positive, 3e-3, 1e6, 0}, {Side::negative, 3e-3, 1e6, 0}};
    StaticSag sag = findStaticSag(model);
    CHECK(sag.displacement.z() == Approx(-2e-3));  // 20 N over 10 N/mm
    CHECK(sag.relative(2, 0) == Approx(-2e-3));
    CHECK(sag.force(2, 0) == Approx(-20));
    REQUIRE(sag.stops.size() == 2);
    CHECK(nameStop(model, sag.stops[0]) == "a.z.+");
    CHECK(sag.stops[0].left == Approx(5e-3));
    CHECK(nameStop(model, sag.stops[1]) == "a.z.-");
    CHECK(sag.stops[1].left == Approx(1e-3));
    // Onto the stop: 1e4 (1e-3 + d) + 1e6 d = 20.
    law.stops[1].clearance = 1e-3;
    sag = findStaticSag(model);
    CHECK(sag.stops[1].left == Approx(-10.0 / 1.01e6));
}

TEST_CASE("functions of a number, and texts of a page") {
    CHECK(positivePart(-1) == 0);
    CHECK(positivePart(2) == 2);
    CHECK(decayedPart(1e-12) == Approx(1e-12).epsilon(1e-9));
    CHECK(decayedPart(-3) == -3);
    CHECK(decayedPart(50) == Approx(1));
    CHECK(reciprocalRoot(4) == 0.5);
    CHECK(perNumber([](double a, double b) { return a * b; }, 3, 5) == 15);
    CHECK(escapeHtml("<a href=\"x\">&</a>") == "&lt;a href=&quot;x&quot;&gt;&amp;&lt;/a&gt;");
    CHECK(quoteScript("</script>").find("</") == std::string::npos);
    CHECK(formatScriptNumber(std::nan("")) == "NaN");
    CHECK(formatScriptNumber(std::numeric_limits<double>::infinity()) == "NaN");
    CHECK(formatScriptNumber(1.23456789) == "1.23457");
}
