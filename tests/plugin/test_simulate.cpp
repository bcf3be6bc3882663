// The executable simulate as a user calls it.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "models/common/units.hpp"
#include "models/recording/recording_reader.hpp"
#include "tests/cli/run_program.hpp"

using wems::Recording;
using wems::test::runProgram;
using wems::test::TemporaryDirectory;

namespace {

const std::string smallsat = WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml";
const std::string single_axis = WEMS_SOURCE_DIR "/models/shipped/single_axis.toml";

Recording readFrom(const TemporaryDirectory& folder, const std::string& name) {
    return wems::readRecording(folder.path() + "/" + name);
}

}  // namespace

TEST_CASE("wrong usage of simulate: one line, exit status 2, no file") {
    const auto arguments = GENERATE(values<std::vector<std::string>>({
        {},
        {smallsat},
        {smallsat, "--sweep", "5:50"},
        {smallsat, "--force", "z=1"},
        {smallsat, "--sweep", "5:50", "--dwell", "5:1", "--force", "z=1"},
        {smallsat, "--sweep", "5:50", "--force", "z=1", "--base-acceleration", "z=1"},
        {smallsat, "--sweep", "5:50", "--force", "w=1"},
        {smallsat, "--sweep", "5:50", "--force", "z="},
        {smallsat, "--sweep", "5:50", "--force", "z=nan"},
        {smallsat, "--sweep", "5:50", "--force", "z=0"},
        {smallsat, "--sweep", "5:50", "--force", "z=1,z=2"},
        {smallsat, "--sweep", "5", "--force", "z=1"},
        {smallsat, "--sweep", "5:50:", "--force", "z=1"},
        {smallsat, "--sweep", "5:5", "--force", "z=1"},
        {smallsat, "--sweep", "0:50", "--force", "z=1"},
        {smallsat, "--sweep", "5:50", "--rate", "-4", "--force", "z=1"},
        {smallsat, "--sweep", "5:50", "--rate", "4", "--linear-rate", "2", "--force", "z=1"},
        {smallsat, "--dwell", "5:1", "--rate", "4", "--force", "z=1"},
        {smallsat, "--dwell", "5:1", "--force", "z=1", "--sample-rate", "0"},
        {smallsat, "--dwell", "5:1", "--force", "z=1", "--accuracy", "-1"},
        {smallsat, "--dwell", "5:1", "--force", "z=1", "--fade", "2"},
        {smallsat, "--dwell", "5:1", "--force", "z=1", "--channels", "jerk"},
        {smallsat, "--dwell", "5:1", "--force", "z=1", "--noise", "jerk=1"},
        {smallsat, "--dwell", "5:1", "--force", "z=1", "--noise", "displacement=-1"},
        {smallsat, "--dwell", "5:1", "--force", "z=1", "--no-such-option"},
        {smallsat, "--half-sine", "0.011", "--force", "z=1"},
        {smallsat, "--half-sine", "0.011:0", "--force", "z=1"},
        {smallsat, "--half-sine", "0.011:1", "--rate", "4", "--force", "z=1"},
        {smallsat, "--half-sine", "0.011:1", "--fade", "0.001", "--force", "z=1"},
        {smallsat, "--half-sine", "0.011:1", "--dwell", "5:1", "--force", "z=1"},
        {smallsat, "--sawtooth", "0.011", "--force", "z=1"},
        {smallsat, "--dwell", "5:1", "--force", "z=1", "--downwards"},
        {smallsat, "--dwell", "5:1", "--force", "z=1", "--q", "10"},
        {smallsat, "--profile", "no_such_file.csv", "--force", "z"},
        {smallsat, "--srs", "no_such_file.csv", "--base-acceleration", "z"},
        {smallsat, "--from-csv", "no_such_file.csv"},
        {"no_such_model.toml", "--dwell", "5:1", "--force", "z=1"},
        {single_axis, "--dwell", "5:1", "--force", "z=1"},  // no bracket: nothing that the force could move
    }));
    CAPTURE(arguments);
    const TemporaryDirectory folder;
    auto all = arguments;
    all.insert(all.end(), {"-o", "run.csv"});
    const auto result = runProgram(SIMULATE_PROGRAM, all, folder.path());
    CHECK(result.exit_status == 2);
    CHECK(result.output.empty());
    CHECK(result.errors.rfind("simulate: ", 0) == 0);
    CHECK(std::count(result.errors.begin(), result.errors.end(), '\n') == 1);
    CHECK(folder.list().empty());
}

TEST_CASE("an output that cannot be written is refused before the simulation") {
    const TemporaryDirectory folder;
    const auto result =
        runProgram(SIMULATE_PROGRAM, {smallsat, "--sweep", "5:50", "--force", "z=1", "-o", "no/such/folder/run.csv"},
                   folder.path());
    CHECK(result.exit_status == 2);
    CHECK(result.errors.find("no/such/folder") != std::string::npos);
}

TEST_CASE("a sample rate that cannot show the excitation is said, one that can is not") {
    const TemporaryDirectory folder;
    for (const bool low : {true, false}) {
        const auto result = runProgram(
            SIMULATE_PROGRAM, {smallsat, "--dwell", "50:0.1", "--force", "z=1", "--sample-rate", low ? "99" : "101"},
            folder.path());
        CHECK(result.exit_status == 0);
        CHECK((result.errors.find("less than two samples") != std::string::npos) == low);
    }
}

TEST_CASE("the sampling rate follows a fast excitation; a contact of too few samples is said") {
    const TemporaryDirectory folder;
    const auto fast =
        runProgram(SIMULATE_PROGRAM,
                   {single_axis, "--dwell", "900:0.05", "--base-acceleration", "z=1", "-o", "run.csv"}, folder.path());
    CHECK_THAT(fast.errors, Catch::Contains("recorded at 5000 Hz"));
    CHECK(readFrom(folder, "run.csv").sampleCount() == 251);
    for (const bool low : {true, false}) {
        const auto result = runProgram(
            SIMULATE_PROGRAM,
            {single_axis, "--dwell", "20:1", "--base-acceleration", "z=15", "--sample-rate", low ? "100" : "2000"},
            folder.path());
        CAPTURE(low, result.errors);
        CHECK(result.exit_status == 0);
        CHECK((result.errors.find("samples at a time") != std::string::npos) == low);
    }
}

TEST_CASE("a sweep by a profile: the base moves as its rows say, in a notch less") {
    const TemporaryDirectory folder;
    folder.write("profile.csv", "from [Hz],to [Hz],level\n5,60,2mm\n5,60,1g\n25,35,0.2g\n");
    const std::vector<std::string> arguments{single_axis,           "--profile", "profile.csv", "--rate", "120",
                                             "--base-acceleration", "z",         "-o",          "run.csv"};
    const auto result = runProgram(SIMULATE_PROGRAM, arguments, folder.path());
    INFO(result.errors);
    REQUIRE(result.exit_status == 0);
    const Recording recording = readFrom(folder, "run.csv");
    const auto& base = recording.find("base.az")->values;
    const auto largest = [&](double from, double to) {  // two octaves a second
        double value = 0;
        for (std::size_t k = 0; k < recording.sampleCount(); ++k) {
            const double f = 5 * std::exp2(2 * recording.time[k]);
            if (f > from && f < to) value = std::max(value, std::abs(base[k]));
        }
        return value;
    };
    constexpr double g = 9.80665;
    CHECK(largest(8, 10) == Approx(2e-3 * std::pow(wems::kTwoPi * 9.8, 2)).epsilon(0.06));  // peaks come every period
    CHECK(largest(16, 24) == Approx(g).epsilon(0.03));
    CHECK(largest(26, 34) == Approx(0.2 * g).epsilon(0.03));
    CHECK(largest(37, 59) == Approx(g).epsilon(0.03));
    // 2 mm and 1 g meet at sqrt(g / 2 mm) / 2π = 11.1446 Hz.
    CHECK_THAT(recording.metadata.at("excitation"), Catch::Contains("level changes at 11.14, 25, 35 Hz"));

    auto half = arguments;
    half[6] = "z=0.5";
    REQUIRE(runProgram(SIMULATE_PROGRAM, half, folder.path()).exit_status == 0);
    CHECK(readFrom(folder, "run.csv").find("base.az")->values[300] == Approx(0.5 * base[300]));
    half[6] = "z=0.5g";
    CHECK(runProgram(SIMULATE_PROGRAM, half, folder.path()).exit_status == 2);
}

TEST_CASE("a shock by its response spectrum is recorded, and the base comes back") {
    const TemporaryDirectory folder;
    folder.write("srs.csv", "20,5\n100,20\n200,20\n");
    const auto result =
        runProgram(SIMULATE_PROGRAM, {single_axis, "--srs", "srs.csv", "--base-acceleration", "z", "-o", "run.csv"},
                   folder.path());
    INFO(result.errors);
    REQUIRE(result.exit_status == 0);
    const Recording recording = readFrom(folder, "run.csv");
    CHECK_THAT(recording.metadata.at("excitation"), Catch::Contains("response spectrum of srs.csv, Q 10, met within"));
    CHECK(std::abs(recording.find("fixed.mount.z")->values.front()) < 1e-12);
    CHECK(std::abs(recording.find("fixed.mount.z")->values.back()) < 1e-6);
}

TEST_CASE("help shows an example, version a version") {
    const TemporaryDirectory folder;
    const auto help = runProgram(SIMULATE_PROGRAM, {"--help"}, folder.path());
    CHECK(help.exit_status == 0);
    CHECK(help.output.find("simulate smallsat.toml --sweep 5:50") != std::string::npos);
    CHECK(help.errors.empty());
    CHECK(runProgram(SIMULATE_PROGRAM, {"--version"}, folder.path()).output.find("0.1") != std::string::npos);
}

TEST_CASE("a sweep is recorded, told, and replayed") {
    const TemporaryDirectory folder;
    const auto run = [&](std::vector<std::string> arguments) {
        const auto result = runProgram(SIMULATE_PROGRAM, arguments, folder.path());
        INFO(result.errors);
        REQUIRE(result.exit_status == 0);
        return result;
    };
    // Downwards, fast, hard enough for stops.
    const auto told =
        run({smallsat, "--sweep", "40:28", "--rate", "60", "--force", "z=500", "--channels", "displacement,velocity",
             "--json", "summary.json", "--report", "page.html", "-o", "run.csv"});
    CHECK(told.output.find("stop reached") != std::string::npos);
    CHECK(folder.list() == std::vector<std::string>{"page.html", "run.csv", "summary.json"});
    const Recording recording = readFrom(folder, "run.csv");
    const double duration = std::log2(40.0 / 28.0);  // one octave a second
    CHECK(recording.sampleCount() == static_cast<std::size_t>(std::floor(duration * 1000)) + 1);
    CHECK(recording.find("mobile.4.vz") != nullptr);
    CHECK(recording.find("mobile.4.az") == nullptr);
    CHECK(recording.metadata.at("level") == "force z=500 N");
    REQUIRE(recording.find("load.fz") != nullptr);
    for (const std::size_t k : {50U, 300U}) {
        const double t = recording.time[k];
        const double phase = wems::kTwoPi * 40 * (std::pow(2, -t) - 1) / (-std::log(2));
        CHECK(recording.find("load.fz")->values[k] == Approx(500 * std::sin(phase)).margin(1e-5));
    }
    std::ifstream file(folder.path() + "/summary.json");
    const auto summary = nlohmann::json::parse(file);
    CHECK(summary.at("stops").size() == 12);
    CHECK(summary.at("samples") == recording.sampleCount());

    run({smallsat, "--from-csv", "run.csv", "-o", "again.csv", "--quiet"});
    const Recording again = readFrom(folder, "again.csv");
    CHECK(again.time == recording.time);
    const auto& first = recording.find("mobile.4.z")->values;
    const auto& second = again.find("mobile.4.z")->values;
    double worst = 0;
    for (std::size_t k = 0; k < 200; ++k) worst = std::max(worst, std::abs(first[k] - second[k]));
    CHECK(worst < 2e-6);  // before the stops make it sensitive; the load is interpolated between its samples
}

TEST_CASE("What a load cell adds to the truth is recorded, and no part of what a replay applies") {
    const TemporaryDirectory folder;
    std::ifstream shipped(smallsat);
    std::ostringstream text;
    text << shipped.rdbuf() << "\n[[sensor]]\nchannel = \"load.fz\"\ngain = 1.1\nzero = 40\n"
         << "[[sensor]]\nchannel = \"mobile.1.az\"\ngain = 0\n";  // a dead channel stops no replay
    std::string model = text.str();
    const std::string modes = "smallsat_bracket.csv";
    model.replace(model.find(modes), modes.size(),
                  std::filesystem::path(smallsat).parent_path().string() + "/" + modes);
    folder.write("model.toml", model);
    const auto run = [&](const std::vector<std::string>& arguments) {
        const auto result = runProgram(SIMULATE_PROGRAM, arguments, folder.path());
        INFO(result.errors);
        REQUIRE(result.exit_status == 0);
    };
    run({"model.toml", "--dwell", "20:0.3", "--force", "z=100", "-o", "run.csv", "--quiet"});
    run({"model.toml", "--from-csv", "run.csv", "-o", "again.csv", "--quiet"});
    const Recording first = readFrom(folder, "run.csv"), again = readFrom(folder, "again.csv");
    CHECK(first.find("load.fz")->values[0] == Approx(40).margin(1e-6));
    for (const char* channel : {"load.fz", "mobile.4.z"})
        for (std::size_t k = 0; k < first.sampleCount(); ++k)
            REQUIRE(again.find(channel)->values[k] == Approx(first.find(channel)->values[k]).margin(2e-6));
}

TEST_CASE("base motion moves a model without bracket") {
    const TemporaryDirectory folder;
    const auto result =
        runProgram(SIMULATE_PROGRAM,
                   {single_axis, "--dwell", "12:0.2", "--base-acceleration", "z=0.5", "--json", "-", "-o", "run.csv"},
                   folder.path());
    INFO(result.errors);
    REQUIRE(result.exit_status == 0);
    CHECK(nlohmann::json::parse(result.output).contains("stops"));
    const Recording recording = readFrom(folder, "run.csv");
    REQUIRE(recording.find("base.az") != nullptr);
    REQUIRE(recording.find("fixed.mount.az") != nullptr);
    for (const std::size_t k : {10U, 77U})  // the fixed part moves with the base
        CHECK(recording.find("fixed.mount.az")->values[k] == Approx(recording.find("base.az")->values[k]).margin(1e-9));
}

TEST_CASE("a run that would take too long ends within seconds, with the law that makes it so") {
    const TemporaryDirectory folder;
    std::ifstream shipped(single_axis);
    std::string text{std::istreambuf_iterator<char>(shipped), {}};
    text.replace(text.find("damping = "), 0, "relaxation = { stiffness_ratio = 0.1, time_constant = 1e-9 }\n");
    folder.write("stiff.toml", text);
    const auto shown = runProgram(SIMULATE_PROGRAM,
                                  {"stiff.toml", "--dwell", "10:100", "--base-acceleration", "z=1", "-o", "run.csv",
                                   "--json", "run.json", "--time-limit", "60"},
                                  folder.path());
    CAPTURE(shown.errors);
    CHECK(shown.exit_status == 2);
    CHECK(std::count(shown.errors.begin(), shown.errors.end(), '\n') == 1);
    CHECK_THAT(shown.errors, Catch::Contains("the fastest law is") && Catch::Contains(".time_constant = 1e-09") &&
                                 Catch::Contains("accepted: a shorter run"));
    CHECK(folder.list() == std::vector<std::string>{"stiff.toml"});
}

TEST_CASE("a random run that no memory holds is refused before the work") {
    const TemporaryDirectory folder;
    const auto shown = runProgram(
        SIMULATE_PROGRAM,
        {single_axis, "--random", "5:500:1e5", "--base-acceleration", "z=1", "-o", "run.csv", "--time-limit", "1"},
        folder.path());
    CAPTURE(shown.errors);
    CHECK(shown.exit_status == 2);
    CHECK_THAT(shown.errors,
               Catch::Contains("GB of memory, this computer has") && Catch::Contains("accepted: a shorter run"));
    CHECK(folder.list().empty());
}

TEST_CASE("an endless run is announced before the work, and ended within seconds") {
    const TemporaryDirectory folder;
    // log2(2000/0.001) octaves at 0.01 a minute: 125 589 s.
    const auto shown = runProgram(SIMULATE_PROGRAM,
                                  {smallsat, "--sweep", "0.001:2000", "--rate", "0.01", "--force", "z=1",
                                   "--sample-rate", "1000", "--time-limit", "1"},
                                  folder.path());
    CAPTURE(shown.errors);
    CHECK(shown.exit_status == 2);
    const auto announced = shown.errors.find("samples of"), ended = shown.errors.find("the whole run would take");
    REQUIRE(announced != std::string::npos);
    REQUIRE(ended != std::string::npos);
    CHECK(announced < ended);
    CHECK_THAT(shown.errors, Catch::StartsWith("simulate: note: 125589"));
    CHECK(std::count(shown.errors.begin(), shown.errors.end(), '\n') == 2);
    CHECK(folder.list().empty());
}
