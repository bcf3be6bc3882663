// The generator of hidden cases against what it promises.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "models/common/units.hpp"
#include "models/parameter_access.hpp"
#include "tests/hidden/hidden_recording.hpp"
#include "tests/hidden/time_scale.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::hidden;

namespace {

constexpr double kRate = 1000;

/// RMS of the second half, where nothing of the beginning is left.
double calcRms(const Eigen::VectorXd& signal) {
    const Eigen::VectorXd half = signal.tail(signal.size() / 2);
    return std::sqrt(half.squaredNorm() / static_cast<double>(half.size()));
}

Eigen::VectorXd makeSine(double frequency, double rate, Eigen::Index samples) {
    Eigen::VectorXd sine(samples);
    for (Eigen::Index k = 0; k < samples; ++k) sine[k] = std::sin(kTwoPi * frequency * static_cast<double>(k) / rate);
    return sine;
}

RunPlan makeRun(Excitation excitation, bool table, double level) {
    RunPlan plan;
    plan.excitation = excitation;
    plan.duration = 3;
    plan.direction = Eigen::Vector3d(0.3, -0.4, 1).normalized();
    plan.level = level;
    tabulate(plan, table, 7);
    return plan;
}

}  // namespace

TEST_CASE("The filter before sampling is a Butterworth low-pass of fourth order") {
    const double corner = 0.1;
    for (const double frequency : {0.02, 0.08, 0.1, 0.15, 0.3}) {
        CAPTURE(frequency);
        Eigen::VectorXd sine = makeSine(frequency * kRate, kRate, 20000);
        const double before = calcRms(sine);
        AntiAliasFilter(corner).apply(sine);
        const double ratio = std::tan(kPi * frequency) / std::tan(kPi * corner);  // bilinear
        CHECK(calcRms(sine) / before == Approx(1 / std::sqrt(1 + std::pow(ratio, 8))).epsilon(1e-3));
    }
}

TEST_CASE("AC coupling is a high-pass of first order") {
    for (const double frequency : {0.2, 0.3, 5.0}) {
        CAPTURE(frequency);
        Eigen::VectorXd sine = makeSine(frequency, 100, 20000);
        const double before = calcRms(sine), x = frequency / 0.3;
        coupleAc(sine, 0.3 / 100);
        CHECK(calcRms(sine) / before == Approx(x / std::hypot(1, x)).epsilon(1e-2));  // whole periods are not met
    }
}

TEST_CASE("A table's travel and acceleration belong together, and it comes back") {
    for (const auto excitation : {Excitation::logarithmic, Excitation::linear, Excitation::random}) {
        const RunPlan plan = makeRun(excitation, true, 1);
        CAPTURE(formatExcitation(plan));
        CHECK(plan.travel[0] == 0);
        double difference = 0, reference = 0;
        for (Eigen::Index k = 1; k + 1 < plan.travel.size(); ++k) {
            const double a = (plan.travel[k + 1] - 2 * plan.travel[k] + plan.travel[k - 1]) * kTableRate * kTableRate;
            difference += std::pow(a - plan.signal[k], 2);
            reference += std::pow(plan.signal[k], 2);
        }
        // A second difference loses (2π f h)² / 12 of its value: 0.2 % at 50 Hz.
        CHECK(std::sqrt(difference / reference) < 3e-3);
        // A unit acceleration at 5 Hz travels 1 mm, random of unit RMS with peaks of four times that.
        CHECK(plan.travel.cwiseAbs().maxCoeff() < 4e-3);
    }
}

TEST_CASE("A slowed device does the same in a longer time") {
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    Random random(seed);
    const double factor = drawLog(random, 0.1, 10);
    CAPTURE(factor);
    MountModel base = drawDevice(random), model = base;
    for (const char* cause : {"friction", "relaxation", "cubic_stiffness", "hysteresis", "stop_dissipation",
                              "gyroscopic", "preload", "stiffness_drift"})
        drawEffect(cause, base, model, random);
    for (auto& connection : model.connections)
        for (auto& law : connection.axis) law.cubic = std::abs(law.cubic);
    const MountModel slow = slowDown(model, factor);
    const RunPlan plan = makeRun(Excitation::logarithmic, false, 60);
    Drive drive = makeDrive(plan), slow_drive = drive;
    slow_drive.rate = drive.rate / factor;
    slow_drive.values /= factor * factor;
    const OutsideEffect none;
    const SetUp set_up;
    const Eigen::MatrixXd one = simulateDevice({model, none, set_up}, drive, kRate, 2500, 0.25e-3).relative;
    const Eigen::MatrixXd other =
        simulateDevice({slow, none, set_up}, slow_drive, kRate / factor, 2500, 0.25e-3 * factor).relative;
    // The same steps in other units: rounding, which contact amplifies.
    CHECK((one - other).norm() < 1e-6 * one.norm());
}

TEST_CASE("A believed model is off by no more than its tolerances, and by something") {
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    Random random(seed);
    const MountModel exact = drawDevice(random);
    const SmallErrors errors = makeSmallErrors(1);
    const MountModel believed = drawBelieved(exact, errors, random);
    const auto check = [&](const std::string& name, double tolerance) {
        CAPTURE(name);
        const double ratio = getParameter(believed, name) / getParameter(exact, name);
        CHECK(std::abs(ratio - 1) <= tolerance);
        CHECK(ratio != 1);
    };
    check("body.mass", 0.0025);
    check("1.z.stiffness", 0.025);
    check("2.x.damping", 0.125);
    check("3.z.+.clearance", 0.015);
    check("3.z.-.stiffness", 0.04);
    check("2.frequency", 0.005);
    CHECK((believed.body.center_of_gravity - exact.body.center_of_gravity).cwiseAbs().maxCoeff() <= 0.5e-3);
    CHECK(stateTolerances(errors, 1).find(ToleranceOf::stiffness) == Approx(0.025));
    CHECK(stateTolerances(makeSmallErrors(0), 1).find(ToleranceOf::mass) == Approx(0.0));
}

TEST_CASE("A sensor at fault is one that is recorded") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    Random random(seed);
    CaseOptions options;
    options.kind = "sensor_gain";
    options.level = 1;
    options.set_up_kind = GENERATE("bracket", "base", "axis");
    for (int draw = 0; draw < 5; ++draw) {
        const HiddenCase hidden = drawCase(options, random);
        REQUIRE(hidden.effects.size() == 1);
        if (hidden.effects.front().cause != options.kind) continue;  // another one, where none of its devices showed it
        CAPTURE(hidden.effects.front().where);
        CHECK(recordRun(hidden, 0, seed).find(hidden.effects.front().where.front()) != nullptr);
    }
}

TEST_CASE("Without noise and small errors the true model follows the recording, in every set-up") {
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    Random random(seed);
    const auto both = [](SetUp::Kind kind, bool base, bool fixed, bool shaken) {
        return SetUp{kind, base, fixed, shaken};
    };
    using Kind = SetUp::Kind;
    for (const SetUp& set_up : {SetUp{}, both(Kind::base, true, false, true), both(Kind::base, false, true, true),
                                both(Kind::axis, true, false, true), both(Kind::axis, false, false, false)}) {
        CAPTURE(formatSetUp(set_up));
        HiddenCase hidden;
        hidden.set_up = set_up;
        hidden.base = set_up.oneAxis() ? drawAxisDevice(random) : drawDevice(random);
        if (set_up.kind != Kind::bracket) hidden.base.bracket.clear();
        for (auto& connection : hidden.base.connections)  // contact aliases
            for (auto& law : connection.axis) law.stops.clear();
        hidden.truth = hidden.base;
        hidden.sensors = drawSensorErrors(0, hidden.base.connections.size(), 1, random);
        hidden.runs[0] = makeRun(Excitation::logarithmic, set_up.baseDriven(), 20);
        if (set_up.oneAxis()) hidden.runs[0].direction = Eigen::Vector3d::UnitZ();
        for (const bool accelerations : {false, true}) {
            CAPTURE(accelerations);
            hidden.displacement_noise = accelerations ? 0 : 1e-12;
            hidden.acceleration_noise = accelerations || set_up.records_base ? 1e-9 : 0;
            const Recording recording = recordRun(hidden, 0, 1);
            const double error = calcError(hidden, 0, hidden.truth, hidden.outside, recording).error();
            CHECK(error < 2e-3);
        }
    }
}
