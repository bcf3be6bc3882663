// The table of unknowns and the catalogue of causes: each row is a number of its own, each hypothesis one of the
// contract.
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "identify/catalogue/hypotheses.hpp"
#include "identify/problem/sensor_layout.hpp"
#include "identify/problem/unknown.hpp"
#include "models/model_tolerance.hpp"

using namespace wems;
using namespace wems::identify;
using namespace wems::identify::updating;

namespace {

/// All channels of the shipped device, of which nothing but the names matters here.
Recording makeRecording(const MountModel& model) {
    Recording recording;
    recording.time = {0, 1};
    for (const Connection& connection : model.connections)
        for (const char* part : {"mobile.", "fixed."})
            for (const char* quantity : {"x", "y", "z", "ax", "ay", "az"})
                recording.channels.push_back(
                    {part + connection.name + "." + quantity, quantity[0] == 'a' ? "m/s^2" : "m", {0, 0}, 0});
    return recording;
}

struct Device {
    MountModel model = readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
    SensorLayout layout = makeSensorLayout({makeRecording(model)}, model);
    TestScales scales{0.003, 0.5, 5, 50, 50};
    UnknownTable table = makeUnknownTable({model, SensorErrors(layout)}, layout, scales, {true, true, true});

    TestState state() const { return {model, SensorErrors(layout)}; }
    Catalogue catalogue() const {
        AxisReach reach(model);
        reach.positive.setConstant(scales.displacement);
        reach.negative.setConstant(scales.displacement);
        return makeCatalogue(table, layout, model, scales, reach, {scales.lowest, scales.highest});
    }
};

/// A Maxwell branch without stiffness has no time constant, so that setting the one begins the other.
bool isOfBranch(const std::string& time_constant, const std::string& ratio) {
    const std::string of_ratio = "stiffness_ratio", of_time = "time_constant";
    const auto at = ratio.find(of_ratio);
    return at != std::string::npos && time_constant == ratio.substr(0, at) + of_time;
}

}  // namespace

TEST_CASE("SensorLayout: a group for each part and quantity, three channels to a triax") {
    const Device device;
    CHECK(device.layout.groups.size() == 4);
    CHECK(device.layout.channels.size() == 4 * 2 * 6);
    CHECK(device.layout.triaxes.size() == 4 * 2 * 2);
    CHECK(device.layout.findChannel("mobile.9.ax") == -1);
    std::map<int, int> members;
    for (const SensorChannel& channel : device.layout.channels) ++members[channel.triax];
    for (const auto& [triax, count] : members) CHECK(count == 3);
    const int found = device.layout.findChannel("fixed.3.ay");
    REQUIRE(found >= 0);
    const SensorChannel& channel = device.layout.channels[static_cast<std::size_t>(found)];
    CHECK(channel.direction == Eigen::Vector3d::UnitY());
    CHECK(channel.position == device.model.connections[2].position);
    CHECK(device.layout.triaxes[static_cast<std::size_t>(channel.triax)].name == "fixed.3.a");
    CHECK(device.layout.hasAccelerations(Part::fixed));
}

TEST_CASE("What guides hold is no unknown and has no cause") {
    Device device;
    device.model.body.free = {false, false, true, false, true, false};
    device.model.connections[0].position = {0.1, 0, 0};
    device.model.connections[1].position = {0.1, 0, 0.05};
    device.table =
        makeUnknownTable({device.model, SensorErrors(device.layout)}, device.layout, device.scales, {true, true, true});
    // Turning about y moves x at a height and z at a distance.
    const auto known = [&](const std::string& name) { return findUnknown(device.table, name) >= 0; };
    CHECK(known("1.z.stiffness"));
    CHECK_FALSE(known("1.x.stiffness"));
    CHECK_FALSE(known("1.y.stiffness"));
    CHECK(known("2.x.stiffness"));
    CHECK_FALSE(known("2.y.stiffness"));
    for (const Hypothesis& hypothesis : device.catalogue().hypotheses)
        for (const std::string& place : hypothesis.where) {
            CAPTURE(hypothesis.cause, place);
            CHECK(place.rfind("1.x", 0) != 0);
            CHECK(place.find(".y") != 1);
        }
}

TEST_CASE("Unknowns: friction of equal guides is sought as equal forces, whatever the elastomers beside them") {
    Device device;
    device.model.connections[1].axis[2].stiffness *= 2;
    device.table =
        makeUnknownTable({device.model, SensorErrors(device.layout)}, device.layout, device.scales, {true, true, true});
    const auto reachOf = [&](const char* name) { return device.table[findUnknown(device.table, name)].reach; };
    CHECK(reachOf("1.z.friction_force") == Approx(reachOf("2.z.friction_force")));
    // What an elastomer does goes with its stiffness.
    CHECK(reachOf("2.z.hysteresis_force") / reachOf("1.z.hysteresis_force") ==
          Approx(device.model.connections[1].axis[2].stiffness / device.model.connections[0].axis[2].stiffness));
}

TEST_CASE("Unknowns: setting one number changes that one and no other") {
    const Device device;
    std::set<std::string> names;
    for (const Unknown& row : device.table) {
        CAPTURE(row.name);
        CHECK(names.insert(row.name).second);
        CHECK(row.reach > 0);
        CHECK(row.step > 0);
        CHECK(row.deviation >= 0);
        CHECK(row.deviation <= row.reach);
        CHECK(row.least <= row.believed);
        CHECK(row.believed <= row.most);
        CHECK(row.get(device.state()) == row.believed);
        TestState moved = device.state();
        // Towards where values are allowed, by far more than round-off.
        const double target = row.believed + row.step <= row.most ? row.believed + row.step : row.believed - row.step;
        row.set(moved, target);
        CHECK(row.get(moved) == Approx(target).epsilon(1e-9).margin(1e-9 * row.step));
        for (const Unknown& other : device.table) {
            if (other.name == row.name || isOfBranch(other.name, row.name)) continue;
            CAPTURE(other.name);
            CHECK(other.get(moved) == Approx(other.believed).epsilon(1e-12).margin(1e-12 * other.step));
        }
        CHECK(findUnknown(device.table, row.name) == &row - device.table.data());
    }
    CHECK(findUnknown(device.table, "9.z.stiffness") == -1);
}

TEST_CASE("Unknowns: the deviation is half of the stated tolerance") {
    Device device;
    int stated = 0;
    for (const Unknown& row : device.table) {
        if (row.kind != UnknownKind::law && row.kind != UnknownKind::body) continue;
        const auto tolerance = parameterTolerance(device.model, row.name);
        if (!tolerance) continue;
        CAPTURE(row.name);
        CHECK(row.deviation == Approx(0.5 * *tolerance));
        ++stated;
    }
    CHECK(stated > 40);
}

TEST_CASE("Catalogue: every cause of the contract has its places, and each cause the same odds in all") {
    const Device device;
    const Catalogue catalogue = device.catalogue();
    std::map<std::string, double> odds;
    std::set<std::string> statements;
    for (const Hypothesis& hypothesis : catalogue.hypotheses) {
        CAPTURE(hypothesis.cause);
        odds[hypothesis.cause] += std::exp(hypothesis.log_prior);
        CHECK_FALSE(hypothesis.where.empty());
        REQUIRE_FALSE(hypothesis.directions.empty());
        for (const Direction& direction : hypothesis.directions)
            for (const auto& [column, weight] : direction) {
                CHECK(column >= 0);
                CHECK(column < catalogue.columns.size());
                CHECK(weight != 0);
            }
        for (const int row : hypothesis.reported) CHECK(row < static_cast<int>(device.table.size()));
    }
    double all = 0;
    for (const auto& [cause, sum] : odds) {
        CAPTURE(cause);
        CHECK(sum == Approx(odds.begin()->second));
        all += sum;
    }
    CHECK(all == Approx(1));
    for (const char* cause : {"cog_offset",
                              "mass",
                              "inertia",
                              "elastomer_stiffness",
                              "stop_stiffness",
                              "clearance",
                              "preload",
                              "viscous_damping",
                              "structural_damping",
                              "friction",
                              "stop_dissipation",
                              "hysteresis",
                              "asymmetric_stiffness",
                              "cubic_stiffness",
                              "relaxation",
                              "stiffness_drift",
                              "gyroscopic",
                              "sensor_delay",
                              "sensor_gain",
                              "sensor_misalignment",
                              "bracket_mode",
                              "load"})
        CHECK(odds.count(cause) == 1);
}
