// identify plan as a user calls it.
#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "run_program.hpp"

using Catch::Contains;
using wems::test::runProgram;
using wems::test::TemporaryDirectory;

#ifdef SIMULATE_PROGRAM

namespace {

void makeAxialRun(const TemporaryDirectory& folder) {
    for (const char* name : {"smallsat_wems.toml", "smallsat_bracket.csv"})
        std::filesystem::copy_file(std::string(WEMS_SOURCE_DIR "/models/shipped/") + name, folder.path() + "/" + name);
    const auto run = runProgram(SIMULATE_PROGRAM,
                                {"smallsat_wems.toml", "--sweep", "5:50", "--rate", "60", "--force", "z=200", "--noise",
                                 "displacement=1e-6,acceleration=0.01", "-q", "-o", "axial.csv"},
                                folder.path());
    CAPTURE(run.errors);
    REQUIRE(run.exit_status == 0);
}

std::vector<std::string> splitWords(const std::string& text) {
    std::istringstream stream(text);
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    return words;
}

}  // namespace

TEST_CASE("plan: table, JSON, page, and a command that simulate takes") {
    const TemporaryDirectory folder;
    makeAxialRun(folder);
    const auto shown = runProgram(IDENTIFY_PROGRAM,
                                  {"plan", "axial.csv", "--model", "smallsat_wems.toml", "--max-force", "200", "--rate",
                                   "60", "-o", "fitted.toml", "--json", "plan.json", "--report", "plan.html"},
                                  folder.path());
    CAPTURE(shown.output, shown.errors);
    REQUIRE(shown.exit_status == 0);
    CHECK_THAT(shown.output, Contains("Proposal 1: sweep ") && Contains("note: limit of the stroke") &&
                                 Contains("simulate fitted.toml --sweep"));
    const auto read = runProgram("/bin/cat", {"plan.json"}, folder.path());
    const auto plan = nlohmann::json::parse(read.output);
    CHECK(plan.at("version") == 2);
    CHECK_THAT(plan.at("program").get<std::string>(), Contains("wems identify"));
    CHECK(plan.at("inputs").size() == 3);  // model, its modes, the recording
    CHECK(plan.at("trusted") == true);
    CHECK(plan.at("limits").at("force") == 200);
    REQUIRE_FALSE(plan.at("proposals").empty());
    const auto& best = plan.at("proposals")[0];
    // What was driven along z alone gains by a drive across.
    CHECK_THAT(best.at("command").get<std::string>(), Contains("x=") || Contains("y="));
    CHECK(best.at("directions").get<int>() > 0);
    for (const auto& interval : best.at("intervals")) {
        CHECK((interval.at("now95").is_null() || interval.at("now95").size() == 2));
        CHECK((interval.at("then95").is_null() || interval.at("then95").size() == 2));
    }
    auto words = splitWords(best.at("command").get<std::string>());
    REQUIRE(words.front() == "simulate");
    words.erase(words.begin());
    const auto next = runProgram(SIMULATE_PROGRAM, words, folder.path());
    CAPTURE(next.errors);
    CHECK(next.exit_status == 0);
    CHECK(folder.list() == std::vector<std::string>{"axial.csv", "fitted.toml", "next.csv", "plan.html", "plan.json",
                                                    "smallsat_bracket.csv", "smallsat_wems.toml"});
}

TEST_CASE("wrong uses of plan: one line, exit status 2, no file") {
    const TemporaryDirectory folder;
    makeAxialRun(folder);
    folder.write("velocities.csv", "time [s],mobile.1.vx [m/s]\n0,0\n0.001,1\n");
    std::string element = "time [s],relative.1.x [m],force.1.x [N]\n";
    for (int k = 0; k < 40; ++k) element += std::to_string(0.001 * k) + ",0.001," + std::to_string(k % 7) + "\n";
    folder.write("element.csv", element);
    const auto files = folder.list();
    const std::vector<std::string> good{"axial.csv", "--model", "smallsat_wems.toml"};
    const std::vector<std::vector<std::string>> wrong{
        {"--max-force", "0"},
        {"--max-force", "-5"},
        {"--max-force", "nan"},
        {"--max-force", "much"},
        {"--max-stroke", "0"},
        {"--max-acceleration", "0"},
        {"--max-displacement", "-1"},
        {"--max-acceleration", "1"},  // the shipped bracket's modes have no participation in a motion of the base
        {"--rate", "0"},
        {"--sweep", "50:5"},
        {"--sweep", "0:5"},
        {"--sweep", "5"},
        {"--proposals", "0"},
        {"--free", "body.mass"},
        {"velocities.csv"},
        {"element.csv"},
        {"none.csv"},
    };
    for (const auto& more : wrong) {
        CAPTURE(more);
        std::vector<std::string> arguments{"plan"};
        arguments.insert(arguments.end(), good.begin(), good.end());
        arguments.insert(arguments.end(), more.begin(), more.end());
        arguments.insert(arguments.end(), {"--json", "plan.json"});
        const auto result = runProgram(IDENTIFY_PROGRAM, arguments, folder.path());
        CAPTURE(result.errors);
        CHECK(result.exit_status == 2);
        CHECK(result.output.empty());
        CHECK(std::count(result.errors.begin(), result.errors.end(), '\n') == 1);
        CHECK(folder.list() == files);
    }
}

#endif

TEST_CASE("plan without a model or without recordings: one line, exit status 2") {
    const TemporaryDirectory folder;
    folder.write("run.csv", "time [s],mobile.1.x [m]\n0,0\n0.001,1\n");
    const auto arguments = GENERATE(values<std::vector<std::string>>({{"plan"},
                                                                      {"plan", "run.csv"},
                                                                      {"plan", "--model", "none.toml"},
                                                                      {"plan", "run.csv", "--model", "none.toml"}}));
    CAPTURE(arguments);
    const auto result = runProgram(IDENTIFY_PROGRAM, arguments, folder.path());
    CHECK(result.exit_status == 2);
    CHECK(std::count(result.errors.begin(), result.errors.end(), '\n') == 1);
    CHECK(result.output.empty());
}
