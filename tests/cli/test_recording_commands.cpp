// inspect, convert and merge as a user calls them.
#include <catch2/catch.hpp>
#include <cmath>

#include "run_program.hpp"

using Catch::Contains;
using wems::test::runProgram;
using wems::test::TemporaryDirectory;

namespace {

/// A sweep of the load and a channel that stands still for 40 ms in its middle.
std::string makeRun(const std::string& channel, double rate, double from) {
    std::string text = "time [s],load.fz [N]," + channel + " [mm]\n";
    for (int k = 0; k < 6 * rate; ++k) {
        const double t = k / rate, phase = 2 * 3.14159265358979 * (5 * t + 2 * t * t);
        const double z = std::sin((t > 3 && t < 3.04 ? 2 * 3.14159265358979 * 33 : phase) - 0.5);
        text += std::to_string(t + from) + "," + std::to_string(200 * std::sin(phase)) + "," + std::to_string(z) + "\n";
    }
    return text;
}

}  // namespace

TEST_CASE("inspect shows channels, what is suspicious and what can be identified") {
    const TemporaryDirectory folder;
    folder.write("run.csv", makeRun("mobile.1.z", 1000, 0));
    const auto shown = runProgram(IDENTIFY_PROGRAM,
                                  {"inspect", "run.csv", "--json", "run.json", "--report", "run.html"}, folder.path());
    CAPTURE(shown.output, shown.errors);
    CHECK(shown.exit_status == 0);
    for (const char* part : {"run.csv: CSV, 6000 samples, 1000 Hz", "sine sweep", "load.fz", "mobile.1.z",
                             "order 1 @ Hz", "mobile.1.z: drop-out", "the load is recorded"})
        CHECK_THAT(shown.output, Contains(part));
    CHECK(folder.list() == std::vector<std::string>{"run.csv", "run.html", "run.json"});
    const auto data = runProgram(IDENTIFY_PROGRAM, {"inspect", "run.csv", "--json", "-", "--strict"}, folder.path());
    CHECK(data.exit_status == 1);
    CHECK_THAT(data.output, Contains("\"kind\": \"drop_out\"") && Contains("\"rate\": 1000"));
}

TEST_CASE("inspect --memory: a recording longer than memory is worked through in blocks") {
    const TemporaryDirectory folder;
    folder.write("run.csv", makeRun("mobile.1.z", 15000, 0));
    const auto whole = runProgram(IDENTIFY_PROGRAM, {"inspect", "run.csv"}, folder.path());
    const auto blocks =
        runProgram(IDENTIFY_PROGRAM, {"inspect", "run.csv", "--memory", "1", "--report", "run.html"}, folder.path());
    CAPTURE(whole.output, blocks.output, blocks.errors);
    CHECK(blocks.exit_status == 0);
    for (const auto& shown : {whole.output, blocks.output})
        CHECK_THAT(shown, Contains("run.csv: CSV, 90000 samples, 15000 Hz, 5.99993 s; sine sweep") &&
                              Contains("mobile.1.z: drop-out") && Contains("the load is recorded"));
    CHECK_THAT(blocks.output, Contains("read in 3 blocks of 32768 rows") && Contains("the first of 1 among 3 blocks"));
    CHECK(folder.list() == std::vector<std::string>{"run.csv", "run.html"});
}

TEST_CASE("convert and back, and merge of two systems") {
    const TemporaryDirectory folder;
    folder.write("a.csv", makeRun("mobile.1.z", 1000, 0));
    folder.write("b.csv", makeRun("mobile.2.z", 400, 17.25));
    const auto to_sto = runProgram(IDENTIFY_PROGRAM, {"convert", "a.csv", "a.sto"}, folder.path());
    CAPTURE(to_sto.output, to_sto.errors);
    CHECK(to_sto.exit_status == 0);
    CHECK_THAT(to_sto.output, Contains("a.sto: 2 channels, 6000 samples from CSV"));
    const auto back = runProgram(IDENTIFY_PROGRAM, {"convert", "a.sto", "again.csv"}, folder.path());
    CHECK_THAT(back.output, Contains("from OpenSim .sto"));
    const auto markers = runProgram(IDENTIFY_PROGRAM, {"convert", "a.csv", "a.trc"}, folder.path());
    CHECK(markers.exit_status == 0);
    CHECK_THAT(markers.errors, Contains("holds positions only: 1 channels are left out (load.fz)"));

    const auto merged = runProgram(
        IDENTIFY_PROGRAM, {"merge", "again.csv", "b.csv", "-o", "c.csv", "--common", "load.fz"}, folder.path());
    CAPTURE(merged.output, merged.errors);
    CHECK(merged.exit_status == 0);
    CHECK_THAT(merged.output, Contains("b.csv: shifted by -17.25") && Contains("c.csv: 3 channels"));
    const auto data = runProgram(
        IDENTIFY_PROGRAM,
        {"merge", "again.csv", "b.csv", "-o", "c.csv", "--common", "load.fz", "--json", "-", "--report", "merge.html"},
        folder.path());
    CHECK_THAT(data.output,
               Contains("\"rate\": 400") && Contains("\"name\": \"mobile.2.z\"") && Contains("shifted by"));
    CHECK_THAT(folder.list(), Catch::VectorContains(std::string("merge.html")));
    const auto converted = runProgram(IDENTIFY_PROGRAM, {"convert", "a.csv", "e.csv", "--json", "-"}, folder.path());
    CHECK_THAT(converted.output, Contains("\"samples\": 6000") && Contains("\"file\": \"e.csv\""));
    const auto apart = runProgram(IDENTIFY_PROGRAM, {"merge", "a.csv", "b.csv", "-o", "d.csv"}, folder.path());
    CHECK(apart.exit_status == 2);
    CHECK_THAT(apart.errors, Contains("no time in common"));
}

#ifdef SIMULATE_PROGRAM
TEST_CASE("simulate writes for OpenSim, and replays what it wrote") {
    const TemporaryDirectory folder;
    const std::string model = WEMS_SOURCE_DIR "/models/shipped/single_axis.toml";
    const auto first =
        runProgram(SIMULATE_PROGRAM, {model, "--dwell", "10:0.5", "--base-acceleration", "z=1", "-q", "-o", "run.sto"},
                   folder.path());
    CAPTURE(first.output, first.errors);
    CHECK(first.exit_status == 0);
    const auto again =
        runProgram(SIMULATE_PROGRAM, {model, "--from-csv", "run.sto", "-q", "-o", "run.csv"}, folder.path());
    CAPTURE(again.output, again.errors);
    CHECK(again.exit_status == 0);
    const auto compared =
        runProgram(IDENTIFY_PROGRAM, {"compare", "run.sto", "run.csv", "--limit", "0.001"}, folder.path());
    CAPTURE(compared.output, compared.errors);
    CHECK(compared.exit_status == 0);
}
#endif

TEST_CASE("set changes parameters by name, and refuses what makes no model") {
    const TemporaryDirectory folder;
    folder.write("mount.toml",
                 "name = \"m\"\n[body]\nmass = 4.0\ninertia = [0.1, 0.1, 0.1]\n[[connection]]\nname = \"a\"\n"
                 "position = [0.0, 0.0, 0.0]\n[connection.z]\nstiffness = 2000.0\n"
                 "stops = [ { side = \"+\", clearance = 1e-3, stiffness = 1e5 } ]\n");
    const auto changed = runProgram(IDENTIFY_PROGRAM,
                                    {"set", "mount.toml", "a.z.stiffness*=1.5", "a.z.+.clearance+=0.5e-3",
                                     "body.mass=5", "-o", "other.toml", "--json", "-"},
                                    folder.path());
    CAPTURE(changed.output, changed.errors);
    CHECK(changed.exit_status == 0);
    CHECK_THAT(changed.output, Contains("\"before\": 2000.0") && Contains("\"value\": 3000.0") &&
                                   Contains("\"value\": 0.0015") && Contains("\"value\": 5.0"));
    const auto again = runProgram(
        IDENTIFY_PROGRAM, {"set", "other.toml", "a.z.stiffness+=0", "-o", "third.toml", "--json", "-"}, folder.path());
    CHECK_THAT(again.output, Contains("\"before\": 3000.0"));
    for (const auto& [change, said] :
         {std::pair("a.z.stiffness*=-1", "a number from 0 on"), std::pair("b.z.stiffness=1", "b.z.stiffness=1"),
          std::pair("a.z.stiffness=", "is no change"), std::pair("=3", "is no change"),
          std::pair("a.z.stiffness=nan", "is no change")}) {
        const auto refused =
            runProgram(IDENTIFY_PROGRAM, {"set", "mount.toml", change, "-o", "bad.toml"}, folder.path());
        CAPTURE(change, refused.errors);
        CHECK(refused.exit_status == 2);
        CHECK_THAT(refused.errors, Contains(said));
    }
    CHECK(folder.list() == std::vector<std::string>{"mount.toml", "other.toml", "third.toml"});
}
