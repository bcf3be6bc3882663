// The commands as a user calls them: one-axis regression and beam, from files to JSON, and what is refused.
#include <catch2/catch.hpp>

#include "models/beam/beam.hpp"
#include "models/recording/recording_writer.hpp"
#include "tests/cli/run_program.hpp"
#include "tests/fit/synthetic_run.hpp"

namespace wems {
namespace {

const char* const device = WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml";

TEST_CASE("paper_methods single-axis writes its terms, singular values and the model for the next level") {
    test::SweepSettings settings;
    settings.force = {0, 0, 200};
    settings.octaves_per_minute = 60;
    settings.sample_rate = 1000;
    const test::TemporaryDirectory folder;
    writeCsv(test::record(test::simulateSweep(readMountModel(device), settings), {0, 0}, 1),
             folder.path() + "/run.csv");
    const auto done = test::runProgram(PAPER_PROGRAM,
                                       {"single-axis", "run.csv", "--model", device, "--damping", "-o", "linear.toml",
                                        "--json", "out.json", "--report", "out.html"},
                                       folder.path());
    CAPTURE(done.errors);
    REQUIRE(done.exit_status == 0);
    CHECK(done.output.find("4.z.stiffness") != std::string::npos);
    CHECK(done.output.find("singular values") != std::string::npos);
    const MountModel linear = readMountModel(folder.path() + "/linear.toml");
    for (const Connection& connection : linear.connections)
        CHECK(connection.axis[2].stiffness == Approx(1e5).epsilon(0.01));
    CHECK(folder.list().size() == 4);
}

TEST_CASE("paper_methods single-axis refuses what it cannot use, in one line, and writes nothing") {
    const test::TemporaryDirectory folder;
    folder.write("run.csv", "time [s],mobile.1.z [m]\n0,0\n1,0\n");
    const auto candidates = test::runProgram(
        PAPER_PROGRAM, {"single-axis", "run.csv", "--model", device, "--candidates", "zz"}, folder.path());
    CHECK(candidates.exit_status == 2);
    CHECK(candidates.errors.find("--candidates") != std::string::npos);
    const auto window = test::runProgram(
        PAPER_PROGRAM, {"single-axis", "run.csv", "--model", device, "--window", "25", "5"}, folder.path());
    CHECK(window.exit_status == 2);
    CHECK(window.errors.find("--window") != std::string::npos);
    const auto channels = test::runProgram(
        PAPER_PROGRAM, {"single-axis", "run.csv", "--model", device, "--json", "out.json"}, folder.path());
    CHECK(channels.exit_status == 2);
    CHECK(folder.list().size() == 1);
}

TEST_CASE("paper_methods beam-tip shows both equations") {
    const test::TemporaryDirectory folder;
    BeamRun run;
    run.force = 10;
    run.sample_rate = 2000;
    writeCsv(simulateBeam(Beam{}, *makeLogarithmicSweep(15, 40, 60), run), folder.path() + "/beam.csv", 13);
    const auto done = test::runProgram(PAPER_PROGRAM, {"beam-tip", "beam.csv", "--json", "beam.json"}, folder.path());
    CAPTURE(done.errors);
    REQUIRE(done.exit_status == 0);
    CHECK(done.output.find("complete") != std::string::npos);
    CHECK(done.output.find("truncated") != std::string::npos);
    const auto missing = test::runProgram(PAPER_PROGRAM, {"beam-tip", "nothing.csv"}, folder.path());
    CHECK(missing.exit_status == 2);
    CHECK(missing.errors.find("nothing.csv") != std::string::npos);
}

}  // namespace
}  // namespace wems
