#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <random>

#include "identify/inspect/connection_checks.hpp"
#include "models/common/error.hpp"
#include "models/recording/recording_reader.hpp"
#include "tests/recording/temporary_file.hpp"
#include "tests/seed.hpp"

using namespace wems;
using Catch::Contains;

namespace {

MountModel makeMount(std::vector<Eigen::Vector3d> positions) {
    MountModel model;
    for (std::size_t i = 0; i < positions.size(); ++i) {
        Connection connection;
        connection.name = std::to_string(i + 1);
        connection.position = positions[i];
        model.connections.push_back(connection);
    }
    return model;
}

MountModel makeCross() {
    return makeMount({{-0.1, 0, 0}, {0.1, 0, 0}, {0, -0.1, 0}, {0, 0.1, 0}});
}

/// No symmetry, so that every exchange is the only one to explain what it does.
MountModel makeIrregular() {
    return makeMount({{-0.1, 0.02, 0.03}, {0.12, 0.01, 0}, {0.03, -0.1, -0.04}, {-0.01, 0.08, 0.01}});
}

/// Finite rotations by Eigen, not the linearised ones of the check; noise of 1 % of the motion.
Recording makeMotion(const MountModel& model, double motion_of_fixed) {
    Recording recording;
    std::mt19937 random(3);
    std::normal_distribution<> noise(0, 1e-5);
    constexpr int count = 500;
    for (int i = 0; i < count; ++i) recording.time.push_back(1e-3 * i);
    for (const auto part : {Part::mobile, Part::fixed}) {
        const double size = part == Part::mobile ? 1.0 : motion_of_fixed;
        for (const auto& connection : model.connections) {
            std::array<Channel, 3> channels;
            for (int axis = 0; axis < 3; ++axis)
                channels[axis].name = formatChannelName({part, connection.name, axis, Derivative::displacement});
            for (const double t : recording.time) {
                const Eigen::Vector3d shift =
                    size * 1e-3 * Eigen::Vector3d(std::sin(60 * t), std::cos(70 * t + size), std::sin(90 * t));
                const Eigen::Matrix3d R =
                    (Eigen::AngleAxisd(size * 0.012 * std::sin(75 * t + size), Eigen::Vector3d::UnitX()) *
                     Eigen::AngleAxisd(size * 0.009 * std::sin(65 * t), Eigen::Vector3d::UnitY()) *
                     Eigen::AngleAxisd(size * 0.007 * std::cos(80 * t), Eigen::Vector3d::UnitZ()))
                        .toRotationMatrix();
                const Eigen::Vector3d u = shift + R * connection.position - connection.position;
                for (int axis = 0; axis < 3; ++axis) channels[axis].values.push_back(u[axis] + noise(random));
            }
            recording.channels.insert(recording.channels.end(), channels.begin(), channels.end());
        }
    }
    return recording;
}

std::vector<double>& values(Recording& recording, const std::string& name) {
    for (auto& channel : recording.channels) {
        if (channel.name == name) return channel.values;
    }
    throw std::logic_error(name);
}

void trade(Recording& recording, const std::string& first, const std::string& second) {
    std::swap(values(recording, first), values(recording, second));
}

}  // namespace

TEST_CASE("A rigid motion has no findings, with the fixed part moving or still") {
    const auto model = makeCross();
    const double motion_of_fixed = GENERATE(0.5, 0.0);
    CHECK(checkAgainstModel(makeMotion(model, motion_of_fixed), model).empty());
}

TEST_CASE("Small faults of a sensor are no exchange") {
    const auto model = makeCross();
    auto recording = makeMotion(model, 0.5);
    for (auto& v : values(recording, "mobile.1.z")) v *= GENERATE(0.9, 1.1);
    CHECK(checkAgainstModel(recording, model).empty());
}

TEST_CASE("Exchanged markers are found, whichever they are") {
    const auto model = makeIrregular();
    auto recording = makeMotion(model, 0.5);
    const auto pair = GENERATE(std::make_pair("mobile.1", "mobile.2"), std::make_pair("mobile.2", "mobile.3"),
                               std::make_pair("fixed.1", "fixed.4"), std::make_pair("mobile.3", "fixed.3"));
    CAPTURE(pair.first, pair.second);
    for (const char* axis : {".x", ".y", ".z"})
        trade(recording, pair.first + std::string(axis), pair.second + std::string(axis));
    const auto findings = checkAgainstModel(recording, model);
    REQUIRE(findings.size() == 1);
    CHECK(findings[0].kind == FindingKind::swapped);
    CHECK(findings[0].channel == pair.first);
    CHECK_THAT(findings[0].message, Contains(std::string(pair.first) + " and " + pair.second + " seem exchanged"));
}

TEST_CASE("Two exchanged cables are found") {
    const auto model = makeIrregular();
    auto recording = makeMotion(model, 0.5);
    const auto pair = GENERATE(std::make_pair("mobile.1.z", "mobile.3.z"), std::make_pair("mobile.1.x", "mobile.1.y"));
    trade(recording, pair.first, pair.second);
    const auto findings = checkAgainstModel(recording, model);
    REQUIRE(findings.size() == 1);
    CHECK_THAT(findings[0].message, Contains(std::string(pair.first) + " and " + pair.second + " seem exchanged"));
}

TEST_CASE("Exchanges that a symmetric cross cannot tell apart are all named") {
    // In the plane of the cross, 1 and 2 traded say the same as 3 and 4 traded: the sign of the turn about z differs
    // between the two arms. Out of it, trading both ends of an arm is another rigid motion.
    const auto model = makeCross();
    auto recording = makeMotion(model, 0.5);
    for (const char* axis : {".x", ".y", ".z"})
        trade(recording, std::string("mobile.1") + axis, std::string("mobile.2") + axis);
    const auto findings = checkAgainstModel(recording, model);
    REQUIRE(findings.size() == 1);
    CHECK_THAT(findings[0].message, Contains("mobile.1 and mobile.2") && Contains("mobile.3 and mobile.4"));
}

TEST_CASE("Connections that only one of recording and model has") {
    auto model = makeCross();
    const auto recording = makeMotion(model, 0.5);
    SECTION("the model lacks one") {
        model.connections.pop_back();
        const auto findings = checkAgainstModel(recording, model);
        REQUIRE(findings.size() == 2);
        CHECK(findings[0].kind == FindingKind::unknown_connection);
        CHECK(findings[0].channel == "mobile.4");
        CHECK(findings[1].channel == "fixed.4");
    }
    SECTION("the recording lacks one") {
        model.connections.push_back(model.connections[0]);
        model.connections.back().name = "5";
        const auto findings = checkAgainstModel(recording, model);
        REQUIRE(findings.size() == 2);
        CHECK(findings[0].kind == FindingKind::missing_connection);
        CHECK(findings[0].channel == "mobile.5");
    }
}

TEST_CASE("Whatever rotation a rigid part makes, its displacements are within the bound") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<> any(-1, 1);
    const auto draw = [&] { return Eigen::Vector3d(any(random), any(random), any(random)); };
    for (int device = 0; device < 50; ++device) {
        const MountModel model = makeMount({draw(), draw(), draw(), draw()});
        Recording recording;
        recording.first_row = 2;
        for (const auto& connection : model.connections)
            for (int axis = 0; axis < 3; ++axis)
                recording.channels.push_back(
                    {formatChannelName({Part::mobile, connection.name, axis, Derivative::displacement}), "m", {}, 0});
        for (int k = 0; k < 100; ++k) {
            recording.time.push_back(k);
            const Eigen::Matrix3d R = Eigen::AngleAxisd(4 * any(random), draw().normalized()).toRotationMatrix();
            const Eigen::Vector3d p = 1e3 * draw();
            for (std::size_t i = 0; i < model.connections.size(); ++i) {
                const Eigen::Vector3d r = model.connections[i].position, u = p + R * r - r;
                for (std::size_t axis = 0; axis < 3; ++axis) recording.channels[3 * i + axis].values.push_back(u[axis]);
            }
        }
        CHECK_NOTHROW(checkRigidBound(recording, model));
        double width = 0;
        for (const auto& one : model.connections)
            for (const auto& other : model.connections) width = std::max(width, (one.position - other.position).norm());
        values(recording, "mobile.3.y")[70] = values(recording, "mobile.1.y")[70] + 4.1 * width;
        values(recording, "mobile.3.y")[71] = values(recording, "mobile.1.y")[71] - 4.1 * width;
        try {
            checkRigidBound(recording, model);
            FAIL("8 widths are no rigid motion");
        } catch (const InputError& error) {
            CHECK(error.location().key == "mobile.3.y");
            CHECK((error.location().line == 72 || error.location().line == 73));
        }
    }
}

TEST_CASE("Connections at one place bound nothing") {
    const MountModel model = makeMount({{0.1, 0, 0}, {0.1, 0, 0}});
    Recording recording;
    recording.time = {0, 1};
    recording.channels = {{"mobile.1.z", "m", {0, 0}, 0}, {"mobile.2.z", "m", {0, 1e6}, 0}};
    CHECK_NOTHROW(checkRigidBound(recording, model));
}

TEST_CASE("Another simulator's recordings raise no alarm") {
    const char* folder = std::getenv("WEMS_EXAMPLES");
    if (folder == nullptr) {
        WARN("skipped: WEMS_EXAMPLES is not set");
        return;
    }
    for (const char* example : {"example_1", "example_2", "example_3", "example_4"}) {
        const std::string path = std::string(folder) + "/" + example;
        const test::TemporaryFile unpacked;
        REQUIRE(std::system(("xz -dc '" + path + "/validate.csv.xz' > '" + unpacked.path() + "'").c_str()) == 0);
        const auto recording = readRecording(unpacked.path());
        INFO(path);
        CHECK(recording.sampleCount() > 1000);
        CHECK(recording.warnings.empty());
        CHECK(checkAgainstModel(recording, readMountModel(path + "/model.toml")).empty());
    }
}
