// What results say of accepted causes, of knobs and of corrected channels, against values by hand.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>

#include "identify/exact/catalogue.hpp"
#include "identify/exact/cause_reports.hpp"
#include "identify/exact/channel_faults.hpp"
#include "models/common/units.hpp"
#include "models/parameter_access.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

MountModel makeModel() {
    MountModel model;
    model.body.mass = 2;
    model.body.inertia.setIdentity();
    model.connections.resize(2);
    for (std::size_t i = 0; i < 2; ++i) {
        model.connections[i].name = std::to_string(i + 1);
        for (AxisLaw& law : model.connections[i].axis) law.stiffness = 1e4 * static_cast<double>(i + 1);
    }
    return model;
}

/// One accepted cause of one knob.
Selection accept(const std::string& cause, const std::string& parameter, double standard_error) {
    Selection selection;
    Candidate candidate;
    candidate.cause = cause;
    candidate.where = {parameter.substr(0, 3)};
    candidate.knobs = {makeKnob(parameter)};
    selection.accepted = {candidate};
    selection.rivals.resize(1);
    selection.models_without = {makeModel()};
    selection.fit.model = makeModel();
    selection.standard_errors = {standard_error};
    return selection;
}

}  // namespace

TEST_CASE("cause report: a probability never exceeds 0.999, a gain never 120 dB, an interval is 1.96 standard errors") {
    Selection selection = accept("elastomer_stiffness", "2.z.stiffness", 100);
    for (const double misfit : {1.0, 1.5, 2.0, 10.0, 1e6, 1e300}) {
        for (const double error : {0.0, 0.1, 1.0, 1e3, 1e200}) {
            const auto causes = makeCauseReports(selection, {{error, misfit}}, {0.1, 1.0}, false);
            REQUIRE(causes.size() == 1);
            CAPTURE(misfit, error);
            CHECK(causes[0].probability >= 0.5);
            CHECK(causes[0].probability <= 0.999);
            CHECK(std::abs(causes[0].gain_db) <= 120);
            if (error == 1) CHECK(causes[0].gain_db == Approx(20));
        }
    }
    // The share of what is left: (2 − 1) / 0.05 = 20 times as much without it.
    const auto causes = makeCauseReports(selection, {{1, 2}}, {0.1, 1.0}, false);
    CHECK(causes[0].probability == Approx(1 - 0.5 / 21));
    const CauseParameter& parameter = causes[0].parameters.front();
    CHECK(parameter.name == "2.z.stiffness");
    CHECK(parameter.value == 2e4);
    // With 0.2 % of the value for what is systematic.
    CHECK(parameter.upper - parameter.value == Approx(std::hypot(1.95996 * 100, 0.002 * 2e4)));
    CHECK(parameter.value - parameter.lower == Approx(parameter.upper - parameter.value));
    // Much is left: what takes away less than four times that is doubtful.
    CHECK(makeCauseReports(selection, {{1, 4}}, {0.1, 2.0}, true)[0].probability < 0.5);
    CHECK(makeCauseReports(selection, {{1, 6}}, {0.1, 2.0}, true)[0].probability > 0.5);
}

TEST_CASE("cause report: causes of one kind become one, the larger gain first") {
    Selection selection = accept("elastomer_stiffness", "2.z.stiffness", 100);
    const Selection other = accept("elastomer_stiffness", "1.x.stiffness", 50),
                    damping = accept("viscous_damping", "1.y.damping", 1);
    for (const Selection* more : {&other, &damping}) {
        selection.accepted.push_back(more->accepted[0]);
        selection.rivals.emplace_back();
        selection.models_without.push_back(makeModel());
        selection.standard_errors.push_back(more->standard_errors[0]);
    }
    const auto causes = makeCauseReports(selection, {{0.2, 3}, {0.4, 3}, {0.8, 3}}, {0.1, 1.0}, false);
    REQUIRE(causes.size() == 2);
    CHECK(causes[0].cause == "viscous_damping");
    CHECK(causes[1].where == std::vector<std::string>{"1.x", "2.z"});
    CHECK(causes[1].gain_db == Approx(20 * std::log10(4.0)));
    CHECK(causes[1].parameters.size() == 2);
}

TEST_CASE("cause report: a sensor's fault, certain unless it rests on laws that leave much") {
    ChannelFault fault;
    fault.cause = "sensor_gain";
    fault.fault.channel = "mobile.1.a";
    fault.fault.gain = 1.1;
    fault.gain_error = 0.01;
    std::vector<Cause> causes;
    addSensorCause(fault, 10, false, causes);
    REQUIRE(causes.size() == 1);
    CHECK(causes[0].probability == 0.999);
    CHECK(causes[0].gain_db == Approx(20));
    CHECK(causes[0].where == std::vector<std::string>{"mobile.1"});
    CHECK(causes[0].parameters[0].name == "mobile.1.gain");
    CHECK(causes[0].parameters[0].upper == Approx(1.1 + std::hypot(0, 1.95996 * 0.01)));
    fault.fault.channel = "fixed";
    std::vector<Cause> of_side;
    addSensorCause(fault, 1.5, true, of_side);
    CHECK(of_side[0].probability == kDoubtful);
    of_side.clear();
    addSensorCause(fault, 2.5, true, of_side);
    CHECK(of_side[0].probability == 0.999);
}

TEST_CASE("knobs: one value, a shared one, a common factor, and where each ends") {
    MountModel model = makeModel();
    const Knob one = makeKnob("2.z.stiffness");
    CHECK(one.get(model) == 2e4);
    one.set(model, 3e4);
    CHECK(model.connections[1].axis[2].stiffness == 3e4);
    CHECK(one.lowest(model) >= 0);
    CHECK(one.scale(model) > 0);
    const Knob shared = makeSharedKnob({"1.x.stiffness", "2.x.stiffness"});
    shared.set(model, 5e3);
    CHECK(model.connections[0].axis[0].stiffness == 5e3);
    CHECK(model.connections[1].axis[0].stiffness == 5e3);
    model = makeModel();
    const Knob factor = makeFactorKnob(model, {"1.z.stiffness", "2.z.stiffness", "1.z.damping"});
    CHECK(factor.isFactor());
    CHECK(factor.names.size() == 2);  // a factor on zero is none
    CHECK(factor.get(model) == Approx(1));
    factor.set(model, 1.5);
    CHECK(model.connections[0].axis[2].stiffness == Approx(1.5e4));
    CHECK(model.connections[1].axis[2].stiffness == Approx(3e4));
    CHECK(factor.lowest(model) == 0);
}

TEST_CASE("corrected channels: gain, delay and rotation undone") {
    Recording truth, measured;
    const double delay = 0.7e-3, gain = 1.3;
    const Eigen::Matrix3d R = Eigen::AngleAxisd(0.2, Eigen::Vector3d(1, 2, 2) / 3).toRotationMatrix();
    const auto motion = [](double t) {
        return Eigen::Vector3d(std::sin(kTwoPi * 5 * t), std::cos(kTwoPi * 7 * t), std::sin(kTwoPi * 3 * t + 1));
    };
    for (const char* axis : {"ax", "ay", "az"})
        for (Recording* recording : {&truth, &measured})
            recording->channels.push_back({std::string("mobile.1.") + axis, "m/s^2", {}, 0});
    for (int k = 0; k < 1000; ++k) {
        const double t = 1e-3 * k;
        const Eigen::Vector3d now = motion(t), seen = gain * (R * motion(t - delay));
        for (std::size_t a = 0; a < 3; ++a) {
            truth.channels[a].values.push_back(now[a]);
            measured.channels[a].values.push_back(seen[a]);
        }
        truth.time.push_back(t);
        measured.time.push_back(t);
    }
    SensorFault fault;
    fault.channel = "mobile.1.a";
    fault.gain = gain;
    fault.delay = delay;
    fault.rotation = 0.2 * Eigen::Vector3d(1, 2, 2) / 3;
    const Recording corrected = correctChannels(measured, {fault});
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t k = 10; k < 990; ++k)  // a cubic through samples 1 ms apart: (2 π 7 · 1e-3)⁴ · 3/128
            REQUIRE(corrected.channels[a].values[k] == Approx(truth.channels[a].values[k]).margin(1e-6));
}
