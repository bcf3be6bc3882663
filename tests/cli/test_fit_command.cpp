// identify fit as a user calls it: a test of several runs, a laboratory's own sensors, a recording longer than memory.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "models/parameter_access.hpp"
#include "models/recording/recording_writer.hpp"
#include "run_program.hpp"
#include "tests/fit/coarse_oscillator.hpp"
#include "tests/fit/laboratory_layout.hpp"
#include "tests/fit/synthetic_run.hpp"
#include "tests/seed.hpp"

namespace wems {
namespace {

using Catch::Contains;
using test::runProgram;

constexpr test::SensorNoise sensors{1e-6, 0.01};

MountModel makeDevice() {
    return readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
}

test::SyntheticRun simulate(double force, double octaves_per_minute) {
    test::SweepSettings settings;
    settings.force = {0, 0, force};
    settings.octaves_per_minute = octaves_per_minute;
    return test::simulateSweep(makeDevice(), settings);
}

/// A folder with a model beside which the truth is known: every value off by a random factor within 1 ± `most`.
struct BelievedDevice {
    explicit BelievedDevice(double most) {
        std::filesystem::copy_file(WEMS_SOURCE_DIR "/models/shipped/smallsat_bracket.csv",
                                   folder.path() + "/smallsat_bracket.csv");
        writeMountModel(test::perturb(truth, most, seed), folder.path() + "/believed.toml");
    }

    std::uint64_t seed = test::drawSeed();
    test::TemporaryDirectory folder;
    MountModel truth = makeDevice();
};

std::string formatLayout(const std::vector<SensorPlace>& places) {
    std::ostringstream text;
    text.precision(17);
    const auto write = [&text](const char* key, const Eigen::Vector3d& v) {
        text << key << " = [" << v.x() << ", " << v.y() << ", " << v.z() << "]\n";
    };
    text << std::showpoint;
    for (const SensorPlace& place : places) {
        text << (place.accelerometer ? "[[accelerometer]]\n" : "[[marker]]\n") << "name = \"" << place.name
             << "\"\npart = \"" << (place.part == Part::mobile ? "mobile" : "fixed") << "\"\n";
        write("position", place.position);
        write("rotation", place.rotation);
    }
    return text.str();
}

nlohmann::json readJson(const test::TemporaryDirectory& folder, const std::string& name) {
    std::ifstream stream(folder.path() + "/" + name);
    return nlohmann::json::parse(stream);
}

struct Estimate {
    double value = 0, error = 0;
};
/// Stiffnesses along z, by name.
std::map<std::string, Estimate> listAxial(const nlohmann::json& fit) {
    std::map<std::string, Estimate> found;
    for (const auto& parameter : fit.at("parameters")) {
        const auto name = parameter.at("name").get<std::string>();
        if (name.find("z.stiffness") != std::string::npos)
            found[name] = {parameter.at("value"), parameter.at("standard_error")};
    }
    return found;
}

}  // namespace

TEST_CASE("fit --test and fit --geometry: a laboratory's sensors tell the same as the ideal layout") {
    const BelievedDevice device(0.25);
    const auto& folder = device.folder;
    const auto seed = device.seed;
    CAPTURE(seed);
    const auto places = test::makeLayout(seed);
    folder.write("layout.toml", formatLayout(places));
    const test::SyntheticRun run = simulate(200, 16), other = simulate(120, 16);
    writeRecording(test::record(run, sensors, seed), folder.path() + "/ideal.csv");
    writeRecording(test::recordLayout(run, places, sensors, seed + 1), folder.path() + "/laboratory.csv");
    writeRecording(test::recordLayout(other, places, sensors, seed + 2), folder.path() + "/other.csv");
    folder.write("campaign.toml",
                 "name = \"axial\"\nmodel = \"believed.toml\"\ngeometry = \"layout.toml\"\n"
                 "[[run]]\nfile = \"laboratory.csv\"\nlevel = \"200 N\"\ndirection = \"z\"\nrole = \"identify\"\n"
                 "[[run]]\nfile = \"other.csv\"\nlevel = \"120 N\"\ndirection = \"z\"\nrole = \"validate\"\n");
    const auto fit = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), "fit");
        const auto result = runProgram(IDENTIFY_PROGRAM, arguments, folder.path());
        CAPTURE(result.errors);
        CHECK(result.exit_status == 0);
        return result.output;
    };
    fit({"ideal.csv", "--model", "believed.toml", "--json", "ideal.json"});
    fit({"laboratory.csv", "--model", "believed.toml", "--geometry", "layout.toml", "--json", "laboratory.json"});
    const std::string shown = fit({"--test", "campaign.toml", "--json", "campaign.json", "-o", "fitted.toml"});
    CHECK_THAT(shown, Contains("validation: other.csv (120 N, z): error"));

    const auto ideal = readJson(folder, "ideal.json"), laboratory = readJson(folder, "laboratory.json"),
               campaign = readJson(folder, "campaign.json");
    CHECK(campaign.at("parameters") == laboratory.at("parameters"));
    REQUIRE(campaign.at("validation").size() == 1);
    CHECK(campaign["validation"][0].at("run") == "other.csv");
    CHECK(campaign["validation"][0].at("error").get<double>() < 0.05);
    const auto expected = listAxial(ideal), found = listAxial(campaign);
    CHECK(found.size() == 4);
    for (const auto& [name, estimate] : found) {
        REQUIRE(expected.count(name) == 1);
        const Estimate same = expected.at(name);
        CAPTURE(name, estimate.value, same.value, estimate.error, same.error);
        // Four standard errors of the difference: exceeded by chance in 1 of 4000 runs of the four together. Sensors
        // taken to stand where they do not, so that a value is off by six, are seen in 98 of 100.
        CHECK(std::abs(estimate.value - same.value) < 4 * std::hypot(estimate.error, same.error));
        CHECK(estimate.value == Approx(getParameter(device.truth, name)).epsilon(0.01));
    }
    const MountModel fitted = readMountModel(folder.path() + "/fitted.toml");
    for (const auto& [name, estimate] : found) CHECK(getParameter(fitted, name) == Approx(estimate.value));
}

TEST_CASE("fit --threads: the result is the same with one and with three, and none is refused") {
    const BelievedDevice device(0.1);
    const auto& folder = device.folder;
    CAPTURE(device.seed);
    writeRecording(test::record(simulate(200, 16), sensors, device.seed), folder.path() + "/one.csv");
    writeRecording(test::record(simulate(120, 16), sensors, device.seed + 1), folder.path() + "/two.csv");
    const auto fit = [&](const std::vector<std::string>& threads) {
        std::vector<std::string> arguments{"fit",           "one.csv", "two.csv", "--model",
                                           "believed.toml", "--json",  "fit.json"};
        arguments.insert(arguments.end(), threads.begin(), threads.end());
        const auto result = runProgram(IDENTIFY_PROGRAM, arguments, folder.path());
        CAPTURE(result.errors);
        REQUIRE(result.exit_status == 0);
        return readJson(folder, "fit.json").at("parameters");
    };
    const auto one = fit({"--threads", "1"});
    CHECK(!one.empty());
    CHECK(fit({"--threads", "3"}) == one);
    CHECK(fit({}) == one);
    const auto none =
        runProgram(IDENTIFY_PROGRAM, {"fit", "one.csv", "--model", "believed.toml", "--threads", "0"}, folder.path());
    CHECK(none.exit_status == 2);
    CHECK_THAT(none.errors, Contains("--threads"));
}

TEST_CASE("fit --memory: a recording longer than memory is fitted on blocks of it, and the output says on which") {
    const BelievedDevice device(0.1);
    const auto& folder = device.folder;
    const auto seed = device.seed;
    CAPTURE(seed);
    writeRecording(test::record(simulate(200, 3), {1e-6, -1}, seed), folder.path() + "/long.csv");
    const auto fit = [&](const std::string& memory) {
        return runProgram(IDENTIFY_PROGRAM,
                          {"fit", "long.csv", "--model", "believed.toml", "--memory", memory, "--json", "fit.json"},
                          folder.path());
    };
    const auto blocks = fit("560");
    CAPTURE(blocks.output, blocks.errors);
    CHECK(blocks.exit_status == 0);
    CHECK_THAT(blocks.output, Contains("used 2 of 4 blocks of 32768 rows"));
    const auto result = readJson(folder, "fit.json");
    CHECK(result.at("blocks").at("used") == 2);
    CHECK(result["blocks"].at("of") == 4);
    CHECK(result["blocks"].at("standard_errors_over_all").at("median").get<double>() >= 1);
    const auto found = listAxial(result);
    CHECK(!found.empty());
    for (const auto& [name, estimate] : found) {
        CAPTURE(name, estimate.value, estimate.error);
        CHECK(estimate.value == Approx(getParameter(device.truth, name)).epsilon(0.02));
    }

    const auto whole = fit("2000");
    CHECK(whole.exit_status == 0);
    CHECK_FALSE(readJson(folder, "fit.json").contains("blocks"));
    const auto refused = fit("100");
    CHECK(refused.exit_status == 2);
    CHECK_THAT(refused.errors, Contains("--memory: is too small for a block of 32768 rows (accepted: at least"));
}

namespace {

/// The numbers of a result are those of its model, and those of the truth within five standard errors.
void checkNumbers(const nlohmann::json& result, const MountModel& fitted, const MountModel& truth) {
    for (const auto& parameter : result.at("parameters")) {
        const auto name = parameter.at("name").get<std::string>();
        CAPTURE(name);
        const double value = parameter.at("value"), error = parameter.at("standard_error");
        CHECK(getParameter(fitted, name) == Approx(value));
        CHECK(std::abs(value - getParameter(truth, name)) < 5 * error);
    }
}

}  // namespace

TEST_CASE("fit of coarse displacements follows simulations unasked, writes the zeros, and its model holds elsewhere") {
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const test::TemporaryDirectory folder;
    const test::CoarseOscillator device = test::drawOscillator(random);
    writeRecording(test::recordOscillator(device, 1000, false, 2e-3, random()), folder.path() + "/run.csv");
    writeRecording(test::recordOscillator(device, 600, true, 2e-3, random()), folder.path() + "/other.csv");
    const MountModel truth = device.makeModel();
    writeMountModel(test::mistake(truth, 1.3, random), folder.path() + "/believed.toml");
    const auto fit = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments{"fit", "run.csv", "--model", "believed.toml", "--json", "fit.json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runProgram(IDENTIFY_PROGRAM, arguments, folder.path());
    };
    const auto by_simulation =
        fit({"--free", "1.z.cubic", "--validate", "other.csv", "-o", "fitted.toml", "--report", "fit.html"});
    CAPTURE(by_simulation.output, by_simulation.errors);
    REQUIRE(by_simulation.exit_status == 0);
    CHECK_THAT(by_simulation.output, Contains("fitted to free simulations") && Contains("by free simulation; verdict"));
    const auto result = readJson(folder, "fit.json");
    CHECK(result.at("method") == "simulation");
    CHECK(result.at("verdict") == "identified");
    CHECK(result.at("residual").at("fraction").get<double>() < 3e-3);
    CHECK(result.at("validation")[0].at("error").get<double>() < 0.02);
    const MountModel fitted = readMountModel(folder.path() + "/fitted.toml");
    checkNumbers(result, fitted, truth);
    CHECK(getParameter(fitted, "load.fz.zero") != 0);

    // The equations of motion do not hold them, and have no law but the linear one to offer.
    CHECK(fit({"--method", "motion"}).exit_status == 0);
    CHECK(readJson(folder, "fit.json").at("method") == "motion");
    CHECK(readJson(folder, "fit.json").at("verdict") != "identified");
    const auto refused = fit({"--method", "motion", "--free", "1.z.cubic"});
    CHECK(refused.exit_status == 2);
    CHECK_THAT(refused.errors, Contains("--free 1.z.cubic: not a parameter that can be freed"));
}

TEST_CASE("fit of displacements with few samples of a contact says so, and its numbers hold") {
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    const test::TemporaryDirectory folder;
    const MountModel truth = readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
    test::SweepSettings sweep;
    sweep.force = {0, 0, 500};
    sweep.octaves_per_minute = 16;
    sweep.sample_rate = 500;
    sweep.steps_per_sample = 32;
    writeRecording(test::record(test::simulateSweep(truth, sweep), {1e-6, -1}, seed), folder.path() + "/run.csv");
    std::filesystem::copy(WEMS_SOURCE_DIR "/models/shipped/smallsat_bracket.csv", folder.path());
    writeMountModel(test::perturb(truth, 0.2, seed), folder.path() + "/believed.toml");
    const auto answer = runProgram(
        IDENTIFY_PROGRAM, {"fit", "run.csv", "--model", "believed.toml", "--json", "fit.json", "-o", "fitted.toml"},
        folder.path());
    CAPTURE(answer.output, answer.errors);
    REQUIRE(answer.exit_status == 0);
    CHECK_THAT(answer.output, Contains("contacts between few samples"));
    const auto result = readJson(folder, "fit.json");
    CHECK(result.at("method") == "motion");
    CHECK(result.at("residual").at("over_noise").get<double>() < 1.5);
    const MountModel fitted = readMountModel(folder.path() + "/fitted.toml");
    checkNumbers(result, fitted, truth);
    CHECK(result.at("parameters").size() > 8);  // stiffness and damping of four axes are eight; the others are of stops
}

TEST_CASE("fit --method simulation of a device on its bracket agrees with its equations of motion") {
    const BelievedDevice device(0.1);
    const auto& folder = device.folder;
    CAPTURE(device.seed);
    test::SweepSettings settings;
    settings.force = {0, 0, 40};  // below the stops
    settings.octaves_per_minute = 120;
    settings.sample_rate = 500;
    writeRecording(test::record(test::simulateSweep(makeDevice(), settings), sensors, device.seed),
                   folder.path() + "/run.csv");
    const auto fit = [&](const std::string& method) {
        const auto result = runProgram(
            IDENTIFY_PROGRAM, {"fit", "run.csv", "--model", "believed.toml", "--method", method, "--json", "fit.json"},
            folder.path());
        CAPTURE(result.output, result.errors);
        REQUIRE(result.exit_status == 0);
        return readJson(folder, "fit.json");
    };
    const auto motion = fit("motion"), simulation = fit("simulation");
    CHECK(simulation.at("verdict") == "identified");
    const auto by_motion = listAxial(motion), by_simulation = listAxial(simulation);
    CHECK(!by_simulation.empty());
    for (const auto& [name, estimate] : by_simulation) {
        CAPTURE(name, estimate.value, estimate.error);
        CHECK(estimate.value == Approx(getParameter(device.truth, name)).epsilon(0.02));
        if (by_motion.count(name) > 0) CHECK(estimate.value == Approx(by_motion.at(name).value).epsilon(0.02));
    }
}

}  // namespace wems
