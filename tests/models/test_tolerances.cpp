#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include "models/common/error.hpp"
#include "models/model_tolerance.hpp"
#include "models/parameter_access.hpp"

using namespace wems;

namespace {

const std::string source = WEMS_SOURCE_DIR;

MountModel readEveryKey() {
    return readMountModel(source + "/tests/models/data/every_key.toml");
}

std::string readText(const std::string& name) {
    std::ifstream stream(source + name);
    return std::string(std::istreambuf_iterator<char>(stream), {});
}

}  // namespace

TEST_CASE("every tolerance is in the sample of every key, the reference and the fuzzers' dictionary") {
    const MountModel model = readEveryKey();
    const std::string reference = readText("/models/README.md"), dictionary = readText("/tests/fuzz/toml.dict");
    for (std::size_t k = 0; k < kToleranceKeys.size(); ++k) {
        const std::string key = kToleranceKeys[k].key;
        CAPTURE(key);
        const auto given = model.tolerances.find(static_cast<ToleranceOf>(k));
        REQUIRE(given);
        CHECK(*given != kToleranceKeys[k].standard);
        CHECK_THAT(reference, Catch::Contains("`" + key + "`"));
        CHECK_THAT(dictionary, Catch::Contains("\"" + key + "\"") && Catch::Contains("\"" + key + " = \""));
    }
}

TEST_CASE("tolerances of one item win over the model's, and those over the defaults") {
    MountModel model = readEveryKey();
    const auto& left_z = model.connections[0].axis_tolerances[2];
    CHECK(toleranceOf(model, ToleranceOf::stiffness, left_z) == 0.02);
    CHECK(toleranceOf(model, ToleranceOf::clearance, left_z) == 0);
    CHECK(toleranceOf(model, ToleranceOf::stiffness, model.connections[0].axis_tolerances[0]) == 0.11);
    CHECK(toleranceOf(model, ToleranceOf::position, model.connections[0].tolerances) == 1e-4);
    CHECK(toleranceOf(model, ToleranceOf::position, model.connections[1].tolerances) == 6e-4);
    CHECK(model.replaced_modes == std::vector<int>{2});  // a tolerance alone replaces nothing
    model.tolerances = {};
    CHECK(toleranceOf(model, ToleranceOf::stiffness, model.connections[0].axis_tolerances[0]) == 0.10);
    CHECK(toleranceOf(model, ToleranceOf::load_gain) == 0.01);
}

TEST_CASE("the defaults are those of the interface") {
    const MountModel none;
    const double expected[] = {0.005, 1e-3, 0.05, 0.10, 0.30, 0.05, 0.15, 5e-4,
                               0.02,  0.50, 0.05, 0.01, 0.01, 0.01, 1e-3, 2e-5};
    for (std::size_t k = 0; k < kToleranceKeys.size(); ++k)
        CHECK(toleranceOf(none, static_cast<ToleranceOf>(k)) == expected[k]);
}

TEST_CASE("the tolerance of a parameter is in its own unit") {
    const MountModel model = readEveryKey();
    const auto check = [&model](const std::string& name, double expected) {
        CAPTURE(name);
        const auto tolerance = parameterTolerance(model, name);
        REQUIRE(tolerance);
        CHECK(*tolerance == Approx(expected).epsilon(1e-12).margin(0));
    };
    check("left.z.stiffness", 0.02 * 1e5);
    check("left.x.stiffness", 0.11 * 2.6e4);
    check("left.z.damping", 0.5 * 97.5);
    check("left.x.-.clearance", 0.051 * 2e-3);
    check("left.z.+.clearance", 0);
    check("left.z.-.stiffness", 0.2 * 1.3e6);
    check("body.mass", 0.001 * 8);
    check("body.center_of_gravity.y", 2e-3);
    check("body.inertia.Izz", 0.1 * 0.03);
    check("body.inertia.Ixz", 0.1 * std::sqrt(0.12 * 0.03));
    check("body.inertia.Iyz", 0.1 * std::sqrt(0.13 * 0.03));
    check("1.frequency", 0.03 * 34);
    check("2.frequency", 0.021 * 45);
    check("2.damping_ratio", 0.51 * 0.015);
    check("2.base.uz", 0.052 * 12.2);
    check("load.gain", 0.02);
    check("fixed.right.gain", 0.002);
    check("fixed.right.ry", 0.02);
    check("fixed.right.az.delay", 1e-4);
    check("mobile.left.az.gain", 0.011 * 1.02);
    check("mobile.right.az.delay", 2.1e-5);
    const BracketMode& first = model.bracket[0];
    check("1.uz",
          0.06 * std::max(first.translation.cwiseAbs().maxCoeff(), first.load_translation.cwiseAbs().maxCoeff()));
    check("1.rx", 0.06 * first.rotation.cwiseAbs().maxCoeff());
    for (const char* name : {"left.z.quadratic", "left.z.cubic", "left.z.offset", "left.x.+.clearance", "body.spin.z"})
        CHECK(!parameterTolerance(model, name));
    CHECK_THROWS_AS(parameterTolerance(model, "up.z.stiffness"), InputError);
}

TEST_CASE("the longest name of a sensor wins, key by key") {
    MountModel model = readEveryKey();
    SensorFault side, channel;
    side.channel = "mobile";
    side.tolerances.set(ToleranceOf::sensor_gain, 0.1);
    side.tolerances.set(ToleranceOf::sensor_delay, 1e-3);
    channel.channel = "mobile.left.az";
    channel.tolerances.set(ToleranceOf::sensor_gain, 0.2);
    model.sensors = {channel, side};
    const Tolerances found = sensorTolerances(model, "mobile.left.az");
    CHECK(found.find(ToleranceOf::sensor_gain) == 0.2);
    CHECK(found.find(ToleranceOf::sensor_delay) == 1e-3);
    CHECK(sensorTolerances(model, "mobile.left.ax").find(ToleranceOf::sensor_gain) == 0.1);
    CHECK(sensorTolerances(model, "fixed.left.az").empty());
}

TEST_CASE("A model is exactly known if every tolerance is zero, those of single items too") {
    MountModel model = readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
    CHECK_FALSE(isExactlyKnown(model));  // defaults
    for (std::size_t i = 0; i < kToleranceKeys.size(); ++i) model.tolerances.set(static_cast<ToleranceOf>(i), 0.0);
    CHECK(isExactlyKnown(model));
    const MountModel exact = model;
    const auto stateOne = [&](MountModel& changed, Tolerances& item, ToleranceOf what) {
        item.set(what, 0.0);
        CHECK(isExactlyKnown(changed));
        item.set(what, 0.01);
        CHECK_FALSE(isExactlyKnown(changed));
    };
    stateOne(model = exact, model.body.tolerances, ToleranceOf::mass);
    stateOne(model = exact, model.connections[1].tolerances, ToleranceOf::position);
    stateOne(model = exact, model.connections[1].axis_tolerances[2], ToleranceOf::stiffness);
    stateOne(model = exact, model.bracket[0].tolerances, ToleranceOf::mode_shape);
    model = exact;
    model.sensors.emplace_back();
    stateOne(model, model.sensors.back().tolerances, ToleranceOf::sensor_gain);
}
