#include <unistd.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "models/axis_numbers.hpp"
#include "models/common/error.hpp"
#include "models/common/units.hpp"
#include "models/law_equality.hpp"
#include "models/mount_forces.hpp"
#include "tests/models/random_values.hpp"

using namespace wems;
using Eigen::Vector3d;
using Eigen::VectorXd;
using wems::test::RandomValues;
namespace fs = std::filesystem;

namespace {

const std::string source = WEMS_SOURCE_DIR;

/// A folder of its own, gone at the end.
class TemporaryFolder {
public:
    TemporaryFolder() : path_(fs::temp_directory_path() / ("wems_models_" + std::to_string(::getpid()))) {
        fs::create_directories(path_ / "deeper");
    }
    ~TemporaryFolder() { fs::remove_all(path_); }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const fs::path& path() const { return path_; }

private:
    fs::path path_;
};

void checkSame(const MountModel& a, const MountModel& b) {
    CHECK(a.name == b.name);
    CHECK(a.gravity == b.gravity);
    CHECK(a.body.mass == b.body.mass);
    CHECK(a.body.center_of_gravity == b.body.center_of_gravity);
    CHECK(a.body.inertia == b.body.inertia);
    CHECK(a.body.spin == b.body.spin);
    CHECK(a.body.free == b.body.free);
    REQUIRE(a.load_point.has_value() == b.load_point.has_value());
    if (a.load_point) {
        CHECK(a.load_point->part == b.load_point->part);
        CHECK(a.load_point->position == b.load_point->position);
    }
    CHECK(a.tolerances == b.tolerances);
    CHECK(a.body.tolerances == b.body.tolerances);
    REQUIRE(a.connections.size() == b.connections.size());
    for (std::size_t i = 0; i < a.connections.size(); ++i) {
        CHECK(a.connections[i].name == b.connections[i].name);
        CHECK(a.connections[i].position == b.connections[i].position);
        CHECK(a.connections[i].tolerances == b.connections[i].tolerances);
        CHECK(a.connections[i].axis_tolerances == b.connections[i].axis_tolerances);
        for (std::size_t k = 0; k < 3; ++k) CHECK(a.connections[i].axis[k] == b.connections[i].axis[k]);
    }
    REQUIRE(a.bracket.size() == b.bracket.size());
    for (std::size_t j = 0; j < a.bracket.size(); ++j) {
        CHECK(a.bracket[j].frequency == b.bracket[j].frequency);
        CHECK(a.bracket[j].damping_ratio == b.bracket[j].damping_ratio);
        CHECK(a.bracket[j].translation == b.bracket[j].translation);
        CHECK(a.bracket[j].tolerances == b.bracket[j].tolerances);
    }
    CHECK(a.replaced_modes == b.replaced_modes);
    REQUIRE(a.load.has_value() == b.load.has_value());
    if (a.load) {
        CHECK(a.load->gain_over_frequency == b.load->gain_over_frequency);
        CHECK(a.load->axis_gain == b.load->axis_gain);
    }
    REQUIRE(a.sensors.size() == b.sensors.size());
    for (std::size_t i = 0; i < a.sensors.size(); ++i) {
        CHECK(a.sensors[i].channel == b.sensors[i].channel);
        CHECK(a.sensors[i].gain == b.sensors[i].gain);
        CHECK(a.sensors[i].delay == b.sensors[i].delay);
        CHECK(a.sensors[i].rotation == b.sensors[i].rotation);
        CHECK(a.sensors[i].zero == b.sensors[i].zero);
        CHECK(a.sensors[i].tolerances == b.sensors[i].tolerances);
    }
    REQUIRE(a.places.size() == b.places.size());
    for (std::size_t i = 0; i < a.places.size(); ++i) {
        CHECK(a.places[i].name == b.places[i].name);
        CHECK(a.places[i].part == b.places[i].part);
        CHECK(a.places[i].accelerometer == b.places[i].accelerometer);
        CHECK(a.places[i].position == b.places[i].position);
        CHECK(a.places[i].rotation == b.places[i].rotation);
        CHECK(a.places[i].noise == b.places[i].noise);
        CHECK(a.places[i].columns == b.places[i].columns);
    }
}

}  // namespace

TEST_CASE("every key lands in its place") {
    const MountModel model = readMountModel(source + "/tests/models/data/every_key.toml");
    CHECK(model.name == "every key");
    CHECK(model.gravity == Vector3d(0, 0.5, -9.81));
    CHECK(model.body.mass == 8);
    CHECK(model.body.center_of_gravity == Vector3d(0.001, -0.002, 0.1415));
    Eigen::Matrix3d inertia;
    inertia << 0.12, 0.001, -0.002, 0.001, 0.13, 0.003, -0.002, 0.003, 0.03;
    CHECK(model.body.inertia == inertia);
    CHECK(model.body.spin == Vector3d(0, 0.1, 3));
    CHECK(model.body.free == std::array<bool, 6>{true, true, true, true, false, true});
    REQUIRE(model.load_point);
    CHECK(model.load_point->part == Part::mobile);
    CHECK(model.load_point->position == Vector3d(0.01, 0.02, 0.1));
    REQUIRE(model.connections.size() == 2);
    CHECK(model.connectionIndex("right") == 1);
    CHECK_THROWS_WITH(model.connectionIndex("up"), Catch::Contains("up") && Catch::Contains("left, right"));
    const AxisLaw& x = model.connections[0].axis[0];
    REQUIRE(x.stops.size() == 1);
    CHECK(x.stops[0].side == Side::negative);
    CHECK(x.stops[0].clearance == 2e-3);
    CHECK(x.stops[0].stiffness == 5.24e5);
    CHECK(x.stops[0].dissipation == 0.7);
    const AxisLaw& z = model.connections[0].axis[2];
    CHECK(z.stiffness == 1e5);
    CHECK(z.damping == 97.5);
    CHECK(z.offset == 1e-4);
    CHECK(z.quadratic == -3e6);
    CHECK(z.cubic == 2e9);
    CHECK(z.loss_factor == 0.1);
    CHECK(z.drift == -1e-3);
    REQUIRE((z.relaxation && z.friction && z.friction->presliding_stiffness));
    CHECK(z.relaxation->stiffness_ratio == 0.2);
    CHECK(z.relaxation->time_constant == 0.01);
    CHECK(z.friction->force == 12);
    CHECK(z.friction->transition_velocity == 1e-3);
    CHECK(*z.friction->presliding_stiffness == 1e5);
    REQUIRE(z.hysteresis);
    CHECK(z.hysteresis->force == 40);
    CHECK(z.hysteresis->yield_displacement == 2e-4);
    CHECK(z.hysteresis->exponent == 1.5);
    CHECK(z.hysteresis->shape == 0.6);
    REQUIRE(z.branches.size() == 2);
    CHECK(z.branches[1] == MaxwellBranch{1e4, 0.5});
    REQUIRE(z.spectrum.size() == 1);
    CHECK(z.spectrum[0] == Relaxation{0.05, 0.004});
    REQUIRE(z.sliders.size() == 2);
    CHECK(z.sliders[0] == Slider{20, 1e-4, 0, {}, {}});
    CHECK(z.sliders[1] == Slider{30, 3e-4, 1e-3, 35.0, 4.0});
    CHECK(AxisForce(model.connections[0].axis[1]).calcForce(1e-3, 1, 0, nullptr) == 0);
    REQUIRE(model.bracket.size() == 2);
    CHECK(model.bracket[0].frequency == 34);
    CHECK(model.bracket[1].frequency == 45);
    CHECK(model.bracket[1].damping_ratio == 0.015);
    CHECK(model.bracket[1].base_participation == Vector3d(0, 0, -12.2));
    CHECK(model.replaced_modes == std::vector<int>{2});
    REQUIRE(model.load);
    CHECK(model.load->gain_over_frequency[1] == std::pair<double, double>(29.0, 0.7));
    REQUIRE(model.sensors.size() == 3);
    CHECK(model.sensors[0].gain == 1.02);
    CHECK(model.sensors[0].delay == 1e-4);
    CHECK(model.sensors[1].channel == "fixed.right");
    CHECK(model.sensors[1].rotation == Vector3d(0, 0.01, -0.02));
    CHECK(model.sensors[2].zero == 0.75);
    REQUIRE(model.places.size() == 2);
    CHECK(model.places[0].name == "top");
    CHECK(!model.places[0].accelerometer);
    CHECK(model.places[0].position == Vector3d(0.01, 0.02, 0.3));
    CHECK(model.places[0].columns[2] == "M1 Z [mm]");
    CHECK(model.places[1].part == Part::fixed);
}

TEST_CASE("every number of a law is in the sample of every key, in the reference and in the fuzzers' dictionary") {
    const AxisLaw law = readMountModel(source + "/tests/models/data/every_key.toml").connections[0].axis[2];
    const auto load = [](const std::string& name) {
        std::ifstream stream(source + name);
        return std::string(std::istreambuf_iterator<char>(stream), {});
    };
    const std::string reference = load("/models/README.md"), dictionary = load("/tests/fuzz/toml.dict");
    for (const AxisNumber& number : kAxisNumbers) {
        const std::string key = number.key;
        CAPTURE(key);
        CHECK(law.*number.member != 0);
        CHECK_THAT(reference, Catch::Contains("`" + key + "`"));
        CHECK_THAT(dictionary, Catch::Contains("\"" + key + " = \""));
    }
}

TEST_CASE("what is written reads back to the same model") {
    const unsigned seed = GENERATE(range(1U, 60U));
    CAPTURE(seed);
    const MountModel model = RandomValues(seed).model();
    checkSame(parseMountModel(formatMountModel(model, ""), "again.toml"), model);
}

TEST_CASE("names that hold control characters read back") {
    MountModel model = RandomValues(3).model();
    model.name = "tab\t quote\" slash\\ newline\n bell\a é";
    CHECK(parseMountModel(formatMountModel(model, ""), "again.toml").name == model.name);
}

TEST_CASE("a model written to another folder still finds its bracket") {
    const TemporaryFolder folder;
    const fs::path data = source + "/tests/models/data";
    fs::copy_file(data / "every_key.toml", folder.path() / "every_key.toml");
    fs::copy_file(data / "every_key.csv", folder.path() / "every_key.csv");
    const MountModel model = readMountModel((folder.path() / "every_key.toml").string());
    const std::string file = (folder.path() / "deeper" / "extended.toml").string();
    writeMountModel(model, file);
    const MountModel again = readMountModel(file);
    checkSame(again, model);
    CHECK(again.bracket_file == "../every_key.csv");
}

TEST_CASE("a model with an added mode brings a modes file of its own") {
    const TemporaryFolder folder;
    const fs::path data = source + "/tests/models/data";
    MountModel model = readMountModel((data / "every_key.toml").string());
    BracketMode added = model.bracket.front();
    added.frequency = 61.5;
    added.rotation = {1, 2, 3};
    model.bracket.push_back(added);
    const std::string file = (folder.path() / "deeper" / "longer.toml").string();
    writeMountModel(model, file);
    const MountModel again = readMountModel(file);
    checkSame(again, model);
    CHECK(again.bracket_file == "longer_bracket.csv");
    CHECK(again.bracket.back().rotation == added.rotation);
}

// What a diagnosis adjusts of a mode is in no list of replaced rows.
TEST_CASE("a model with other modes than its modes file is written with its own") {
    const TemporaryFolder folder;
    const fs::path data = source + "/tests/models/data";
    MountModel model = readMountModel((data / "every_key.toml").string());
    const std::string file = (folder.path() / "other.toml").string();
    SECTION("frequency and damping ratio, which a model file has keys for") {
        model.bracket[0].frequency = 33.5;
        model.bracket[0].damping_ratio = 0.0123;
        writeMountModel(model, file);
        const MountModel again = readMountModel(file);
        CHECK(again.bracket[0].frequency == 33.5);
        CHECK(again.bracket[0].damping_ratio == 0.0123);
        CHECK(again.bracket[1].frequency == model.bracket[1].frequency);
        CHECK(fs::path(again.bracket_file).filename() == "every_key.csv");
    }
    SECTION("shapes, which it has none for") {
        model.bracket[0].rotation.x() += 0.01;
        model.bracket[1].load_translation.z() += 0.02;
        writeMountModel(model, file);
        const MountModel again = readMountModel(file);
        CHECK(again.bracket[0].rotation == model.bracket[0].rotation);
        CHECK(again.bracket[1].load_translation == model.bracket[1].load_translation);
        CHECK(again.bracket[1].frequency == model.bracket[1].frequency);
        CHECK(again.bracket_file == "other_bracket.csv");
    }
}

TEST_CASE("a model that is no model is not written") {
    const TemporaryFolder folder;
    MountModel model = RandomValues(3).model();
    model.body.mass = -1;
    CHECK_THROWS_AS(writeMountModel(model, (folder.path() / "bad.toml").string()), InputError);
    model.body.mass = 1;
    CHECK_THROWS_AS(writeMountModel(model, (folder.path() / "missing" / "bad.toml").string()), InputError);
    model.bracket.resize(1);
    model.bracket[0].frequency = 10;
    CHECK_THROWS_WITH(writeMountModel(model, (folder.path() / "bad.toml").string()), Catch::Contains("bracket.modes"));
    CHECK(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator{}) == 1);  // deeper/
}

TEST_CASE("shipped models: linear frequencies") {
    // Published design: coupled modes at 11.2, 11.4, 29.5, 30.5, 31.2, 32.4, 35.3, 37.8 and 45.3 Hz; mass matrix and
    // finite differences of the forces here.
    const MountModel model = readMountModel(source + "/models/shipped/smallsat_wems.toml");
    const Bracket bracket(model.bracket);
    const MountForces forces(model);
    const int n = 6 + bracket.modeCount();
    const Vector3d c = model.body.center_of_gravity;
    const auto accelerations = [&](const VectorXd& x) {
        const VectorXd still = VectorXd::Zero(bracket.modeCount());
        BodyMotion mobile;
        mobile.R_GM = rotationFromVector(x.segment<3>(3));
        mobile.p_GM = x.head<3>() + c - mobile.R_GM * c;
        Wrench on_mobile, on_fixed;
        const VectorXd eta = x.tail(bracket.modeCount());
        forces.calc(mobile, bracket.calcMotion(eta, still), 0, nullptr, on_mobile, on_fixed, nullptr);
        VectorXd a(n), modal(bracket.modeCount());
        a.head<3>() = on_mobile.force / model.body.mass;
        const Vector3d moment = on_mobile.moment - crossMatrix(mobile.R_GM * c) * on_mobile.force;
        a.segment<3>(3) = model.body.inertia.diagonal().cwiseInverse().cwiseProduct(moment);
        bracket.calcAccelerations(eta, still, on_fixed, Vector3d::Zero(), Vector3d::Zero(), modal);
        a.tail(bracket.modeCount()) = modal;
        return a;
    };
    Eigen::MatrixXd A(n, n);
    for (int j = 0; j < n; ++j) {
        const VectorXd step = 1e-6 * VectorXd::Unit(n, j);
        A.col(j) = (accelerations(step) - accelerations(-step)) / 2e-6;
    }
    VectorXd hertz = (-A).eigenvalues().real().cwiseSqrt() / kTwoPi;
    std::sort(hertz.data(), hertz.data() + n);
    const double published[] = {11.2, 11.4, 29.5, 30.5, 31.2, 32.4, 35.3, 37.8, 45.3};
    for (int j = 0; j < 9; ++j) CHECK(hertz[j] == Approx(published[j]).margin(0.1));
}

TEST_CASE("shipped models: the single axis has the frequency and damping that its header says") {
    const MountModel model = readMountModel(source + "/models/shipped/single_axis.toml");
    const AxisLaw& z = model.connections[0].axis[2];
    CHECK(std::sqrt(z.stiffness / model.body.mass) / kTwoPi == Approx(15.9).margin(0.05));
    CHECK(z.damping / (2 * std::sqrt(z.stiffness * model.body.mass)) == Approx(0.025));
}
