// Faults of sensors that the model states are taken off, and what is found is told in all.
#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <string>

#include "identify/diagnose/believed_sensors.hpp"
#include "identify/diagnose/diagnose.hpp"
#include "models/bryant.hpp"
#include "models/sensor_reading.hpp"
#include "tests/diagnose/draw_until.hpp"
#include "tests/diagnose/hidden_device.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

/// What sensors with these gains and rotations make of displacements.
Recording distort(const Recording& truth, const std::vector<SensorFault>& faults) {
    Recording seen = truth;
    const auto find = [&](const std::string& name) {
        return std::find_if(truth.channels.begin(), truth.channels.end(),
                            [&](const Channel& channel) { return channel.name == name; });
    };
    for (Channel& channel : seen.channels) {
        const auto name = parseChannelName(channel.name);
        if (!name || name->part == Part::load) continue;
        const SensorReading reading = readingOf(faults, channel.name);
        const std::string place = channel.name.substr(0, channel.name.rfind('.') + 1);
        for (std::size_t k = 0; k < channel.values.size(); ++k) {
            const Eigen::Vector3d vector(find(place + "x")->values[k], find(place + "y")->values[k],
                                         find(place + "z")->values[k]);
            channel.values[k] = reading.gain * reading.R_TS.row(name->axis).dot(vector);
        }
    }
    return seen;
}

}  // namespace

TEST_CASE("What a sensor was believed to do and what was found are told as one") {
    const Eigen::Vector3d believed(0.3, -0.2, 0.1), found(-0.1, 0.4, 0.2);
    const std::vector<SensorFault> sensors{{"mobile.1", 1.1, 1e-3, believed, 0},
                                           {"mobile.1.z", 1.2, 0, Eigen::Vector3d::Zero(), 0}};
    Recording recording;
    for (const char* axis : {"x", "y", "z"})
        recording.channels.push_back({std::string("mobile.1.") + axis, "m", {0.0}, 0});
    Diagnosis diagnosis;
    Cause turned, louder, late;
    for (int axis = 0; axis < 3; ++axis)
        turned.parameters.push_back(
            {std::string("mobile.1.r") + "xyz"[axis], "rad", found[axis], found[axis] - 0.01, found[axis] + 0.02});
    louder.parameters.push_back({"mobile.1.z.gain", "-", 0.5, 0.4, 0.6});
    late.parameters.push_back({"mobile.1.x.delay", "s", 2e-3, 1e-3, 3e-3});
    diagnosis.causes = {turned, louder, late};
    diagnosis.adjustments.push_back({{"mobile.1.y.gain", "-", 1.01, 1.0, 1.02}, 1.0, 0.01});
    diagnosis.adjustments.push_back({{"1.z.stiffness", "N/m", 5e5, 4e5, 6e5}, 5.1e5, 1e4});
    diagnosis.extended = withoutFaults([&] {
        MountModel model;
        model.sensors = sensors;
        return model;
    }());
    diagnosis.extended.sensors[0].rotation = found;
    diagnosis.extended.sensors[1].gain = 0.5;
    addBelievedSensors(sensors, {recording}, diagnosis);

    const Eigen::AngleAxisd all(Eigen::AngleAxisd(believed.norm(), believed.normalized()) *
                                Eigen::AngleAxisd(found.norm(), found.normalized()));
    for (int axis = 0; axis < 3; ++axis) {
        const CauseParameter& number = diagnosis.causes[0].parameters[axis];
        CHECK(number.value == Approx(all.angle() * all.axis()[axis]));
        CHECK(number.lower == Approx(number.value - 0.01));
        CHECK(number.upper == Approx(number.value + 0.02));
    }
    CHECK(diagnosis.causes[1].parameters[0].value == Approx(0.5 * 1.1 * 1.2));
    CHECK(diagnosis.causes[1].parameters[0].lower == Approx(0.4 * 1.1 * 1.2));
    CHECK(diagnosis.causes[2].parameters[0].upper == Approx(4e-3));
    CHECK(diagnosis.adjustments[0].parameter.value == Approx(1.01 * 1.1));
    CHECK(diagnosis.adjustments[0].believed == Approx(1.1));
    CHECK(diagnosis.adjustments[1].parameter.value == 5e5);
    REQUIRE(diagnosis.extended.sensors.size() == 2);
    CHECK((diagnosis.extended.sensors[0].rotation - all.angle() * all.axis()).norm() < 1e-12);
    CHECK(diagnosis.extended.sensors[0].delay == 1e-3);
    CHECK(diagnosis.extended.sensors[1].gain == Approx(0.6));
}

TEST_CASE("A fault that the model states is none to be found, and one beyond it is", "[diagnose]") {
    test::drawUntilClear([&](std::uint64_t seed) -> std::string {
        std::mt19937_64 random(seed);
        MountModel model = testing::makeRandomDevice(random);
        for (std::size_t i = 0; i < kToleranceKeys.size(); ++i) model.tolerances.set(static_cast<ToleranceOf>(i), 0.0);
        std::uniform_real_distribution<double> angle(-0.3, 0.3), gain(0.8, 1.2);
        const auto draw = [&] { return Eigen::Vector3d(angle(random), angle(random), angle(random)); };
        const Eigen::Vector3d believed = draw(), hidden = 0.3 * draw();
        const std::string place = "mobile." + model.connections[0].name, other = "fixed." + model.connections[1].name;
        const MountModel ideal = model;
        model.sensors = {{place, gain(random), 0, believed, 0},
                         {other + ".z", gain(random), 0, Eigen::Vector3d::Zero(), 0}};
        testing::RunPlan plan;
        plan.duration = 8;
        plan.force = {40, 30, 60};
        const Recording first = testing::recordRun(ideal, plan, random);
        plan.upward = false;
        const Recording second = testing::recordRun(ideal, plan, random);

        const auto same = diagnose({distort(first, model.sensors)}, {distort(second, model.sensors)}, model);
        if (same.verdict != Diagnosis::Verdict::nothing_missing) return "stated: " + formatVerdict(same.verdict);

        std::vector<SensorFault> all = model.sensors;
        const Eigen::AngleAxisd total(rotationFromVector(believed) * rotationFromVector(hidden));
        all[0].rotation = total.angle() * total.axis();
        const auto found = diagnose({distort(first, all)}, {distort(second, all)}, model);
        if (found.verdict != Diagnosis::Verdict::explained) return "beyond: " + formatVerdict(found.verdict);
        if (found.causes.size() != 1 || found.causes[0].cause != "sensor_misalignment")
            return "beyond: " + std::to_string(found.causes.size()) + " causes";
        for (const SensorFault& sensor : found.extended.sensors)
            if (sensor.channel == place && (sensor.rotation - all[0].rotation).norm() > 0.02 * hidden.norm())
                return "beyond: turned by another vector";
        return found.extended.sensors.size() == 2 ? "" : "beyond: other sensors";
    });
}
