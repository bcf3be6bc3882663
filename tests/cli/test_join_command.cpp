// identify equations and identify join as a user calls them: one fit of runs that were worked on one by one.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <random>

#include "models/recording/recording_writer.hpp"
#include "run_program.hpp"
#include "tests/fit/synthetic_run.hpp"
#include "tests/seed.hpp"

namespace wems {
namespace {

using Catch::Contains;
using test::runProgram;

std::string readAll(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// Two noisy runs beyond the stops and a model that is off by up to 10 %.
struct Runs {
    Runs() {
        const MountModel truth = readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
        std::filesystem::copy_file(WEMS_SOURCE_DIR "/models/shipped/smallsat_bracket.csv",
                                   folder.path() + "/smallsat_bracket.csv");
        writeMountModel(test::perturb(truth, 0.1, seed), folder.path() + "/believed.toml");
        test::SweepSettings settings;
        settings.octaves_per_minute = 120;
        for (const bool axial : {true, false}) {
            settings.force = axial ? Eigen::Vector3d(0, 0, 500) : Eigen::Vector3d(100, 150, 50);
            writeRecording(test::record(test::simulateSweep(truth, settings), {1e-6, 0.01}, seed + (axial ? 1 : 2)),
                           folder.path() + (axial ? "/axial.csv" : "/oblique.csv"), {});
        }
    }

    test::ProgramResult run(const std::vector<std::string>& arguments) const {
        return runProgram(IDENTIFY_PROGRAM, arguments, folder.path());
    }
    nlohmann::json read(const std::string& name) const {
        return nlohmann::json::parse(readAll(folder.path() + "/" + name));
    }

    std::uint64_t seed = test::drawSeed();
    test::TemporaryDirectory folder;
};

}  // namespace

TEST_CASE("join of equations is the fit of the runs, to the last bit") {
    const Runs runs;
    CAPTURE(runs.seed);
    for (const std::string run : {"axial", "oblique"}) {
        const auto made = runs.run({"equations", run + ".csv", "--model", "believed.toml", "-o", run + ".equations"});
        CAPTURE(made.output, made.errors);
        REQUIRE(made.exit_status == 0);
        CHECK_THAT(made.output, Contains("equations with 25 columns"));
    }
    const auto joined = runs.run({"join", "axial.equations", "oblique.equations", "--model", "believed.toml", "-o",
                                  "joined.toml", "--json", "joined.json"});
    const auto fitted = runs.run(
        {"fit", "axial.csv", "oblique.csv", "--model", "believed.toml", "-o", "fitted.toml", "--json", "fitted.json"});
    CAPTURE(joined.output, joined.errors, fitted.errors);
    REQUIRE(joined.exit_status == 0);
    REQUIRE(fitted.exit_status == 0);
    const nlohmann::json one = runs.read("fitted.json"), other = runs.read("joined.json");
    CHECK(one["parameters"].size() > 20);
    for (const char* key : {"parameters", "not_identifiable", "residual", "verdict"}) CHECK(one[key] == other[key]);
    CHECK(readAll(runs.folder.path() + "/fitted.toml") == readAll(runs.folder.path() + "/joined.toml"));
}

TEST_CASE("join refuses equations of another model, of another kind and damaged ones") {
    const Runs runs;
    CAPTURE(runs.seed);
    REQUIRE(
        runs.run({"equations", "oblique.csv", "--model", "believed.toml", "-o", "run.equations", "-q"}).exit_status ==
        0);
    REQUIRE(runs.run({"set", "believed.toml", "1.z.stiffness*=1.01", "-o", "other.toml", "-q"}).exit_status == 0);
    const std::string whole = readAll(runs.folder.path() + "/run.equations");
    std::mt19937 random(static_cast<unsigned>(runs.seed));
    for (int cut = 0; cut < 8; ++cut) {
        runs.folder.write("cut.equations",
                          whole.substr(0, std::uniform_int_distribution<std::size_t>(1, whole.size() - 1)(random)));
        const auto refused = runs.run({"join", "cut.equations", "--model", "believed.toml", "-o", "out.toml"});
        CAPTURE(refused.errors);
        CHECK(refused.exit_status == 2);
        CHECK_THAT(refused.errors, Contains("cut.equations: damaged"));
    }
    for (const auto& [arguments, said] :
         {std::pair<std::vector<std::string>, const char*>({"join", "run.equations", "--model", "other.toml"},
                                                           "another model"),
          {{"join", "run.equations", "--model", "believed.toml", "--free", "body.inertia"}, "--free"},
          {{"join", "axial.csv", "--model", "believed.toml"}, "not the equations of a run"},
          {{"equations", "axial.csv", "--model", "believed.toml", "-o", "out.toml", "--use", "accelerations"},
           "accelerations alone"}}) {
        const auto refused = runs.run(arguments);
        CAPTURE(refused.errors);
        CHECK(refused.exit_status == 2);
        CHECK_THAT(refused.errors, Contains(said));
    }
    CHECK(!std::filesystem::exists(runs.folder.path() + "/out.toml"));
}

}  // namespace wems
