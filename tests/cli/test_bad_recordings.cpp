// What a user sees of a recording or a command line that cannot be used: one line, exit status 2, and no file.
#include <algorithm>
#include <catch2/catch.hpp>

#include "run_program.hpp"

using wems::test::runProgram;
using wems::test::TemporaryDirectory;

namespace {

const char* const model = R"(name = "corner"
[body]
mass = 2.0
inertia = [0.01, 0.01, 0.01]
[[connection]]
name = "a"
position = [0.1, 0.0, 0.0]
[connection.z]
stiffness = 1.0e4
[[connection]]
name = "b"
position = [-0.1, 0.0, 0.0]
[connection.z]
stiffness = 1.0e4
[[connection]]
name = "c"
position = [0.0, 0.1, 0.0]
[connection.z]
stiffness = 1.0e4
)";

/// A header for all three connections and `rows` rows of a small motion.
std::string recording(int rows) {
    std::string text = "time [s]";
    for (const char* connection : {"a", "b", "c"}) {
        for (const char* axis : {"x", "y", "z"}) text += std::string(",mobile.") + connection + "." + axis + " [mm]";
    }
    text += "\n";
    for (int row = 0; row < rows; ++row) {
        text += std::to_string(0.001 * row);
        for (int i = 0; i < 9; ++i) text += "," + std::to_string(0.01 * ((row * (i + 3)) % 7));
        text += "\n";
    }
    return text;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

std::size_t lineCount(const std::string& text) {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

struct Case {
    const char* what;
    std::string text;
    std::vector<std::string> message;
};

}  // namespace

TEST_CASE("A recording that cannot be used is refused in one line by every command") {
    const auto c = GENERATE(values<Case>({
        {"empty file", "", {"run.csv"}},
        {"header alone", recording(0), {"run.csv"}},
        {"no time", replaced(recording(20), "time [s]", "clock [s]"), {"run.csv", "time"}},
        {"no unit", replaced(recording(20), "mobile.a.z [mm]", "mobile.a.z"), {"run.csv", "mobile.a.z"}},
        {"unknown unit",
         replaced(recording(20), "mobile.a.z [mm]", "mobile.a.z [furlong]"),
         {"furlong", "mm", "um", "in"}},
        {"text for a number", replaced(recording(20), "0.001000,", "0.001000,off"), {"run.csv:3", "mobile.a.x"}},
        {"a field too few", recording(20) + "0.5,1,2\n", {"run.csv:22"}},
        {"a column twice", replaced(recording(20), "mobile.b.x [mm]", "mobile.a.x [mm]"), {"run.csv", "mobile.a.x"}},
        {"binary",
         std::string("\x7f"
                     "ELF\0\0\1\2\3\xff\xfe",
                     11),
         {"run.csv"}},
    }));
    CAPTURE(c.what);
    const TemporaryDirectory folder;
    folder.write("model.toml", model);
    folder.write("run.csv", c.text);
    folder.write("good.csv", recording(20));
    const auto before = folder.list();
    const std::vector<std::vector<std::string>> calls = {
        {"fit", "run.csv", "--model", "model.toml", "-o", "fitted.toml", "--json", "out.json", "--report", "out.html"},
        {"rigidity", "run.csv", "--model", "model.toml", "--json", "out.json"},
        {"compare", "good.csv", "run.csv", "--json", "out.json"},
        {"surface", "run.csv", "--json", "out.json"},
        {"inspect", "run.csv", "--json", "out.json", "--report", "out.html"},
        {"convert", "run.csv", "out.sto"},
        {"merge", "good.csv", "run.csv", "-o", "out.csv"},
    };
    for (const auto& arguments : calls) {
        const auto result = runProgram(IDENTIFY_PROGRAM, arguments, folder.path());
        CAPTURE(arguments, result.output, result.errors);
        CHECK(result.exit_status == 2);
        CHECK(lineCount(result.errors) == 1);
        for (const auto& part : c.message) CHECK_THAT(result.errors, Catch::Contains(part));
        CHECK(folder.list() == before);
    }
}

TEST_CASE("A command line that makes no sense is refused with status 2") {
    const TemporaryDirectory folder;
    folder.write("model.toml", model);
    folder.write("run.csv", recording(20));
    const auto before = folder.list();
    std::vector<std::pair<std::string, std::vector<std::string>>> calls = {
        {IDENTIFY_PROGRAM, {}},
        {IDENTIFY_PROGRAM, {"frobnicate"}},
        {IDENTIFY_PROGRAM, {"fit", "run.csv"}},
        {IDENTIFY_PROGRAM, {"fit", "nowhere.csv", "--model", "model.toml"}},
        {IDENTIFY_PROGRAM, {"fit", "run.csv", "--model", "nowhere.toml"}},
        {IDENTIFY_PROGRAM, {"fit", "run.csv", "--model", "model.toml", "--columns", "nowhere.toml"}},
        {IDENTIFY_PROGRAM, {"compare", "run.csv"}},
        {IDENTIFY_PROGRAM, {"fit", "--model", "model.toml"}},
        {IDENTIFY_PROGRAM, {"fit", "run.csv", "--test", "nowhere.toml", "--model", "model.toml"}},
        {IDENTIFY_PROGRAM, {"fit", "--test", "nowhere.toml", "--model", "model.toml"}},
        {IDENTIFY_PROGRAM, {"fit", "run.csv", "--model", "model.toml", "--geometry", "model.toml"}},
        {IDENTIFY_PROGRAM, {"convert", "run.csv", "out.mat"}},
        {IDENTIFY_PROGRAM, {"convert", "run.csv", "nowhere/out.csv"}},
        {IDENTIFY_PROGRAM, {"merge", "run.csv", "-o", "out.csv"}},
    };
#ifdef SIMULATE_PROGRAM
    const std::vector<std::vector<std::string>> simulations = {
        {},
        {"model.toml", "-o", "out.csv"},
        {"model.toml", "--sweep", "5", "--force", "z=1", "-o", "out.csv"},
        {"model.toml", "--sweep", "0:50", "--force", "z=1", "-o", "out.csv"},
        {"model.toml", "--sweep", "5:50", "--rate", "-4", "--force", "z=1", "-o", "out.csv"},
        {"model.toml", "--sweep", "5:50", "--force", "w=1", "-o", "out.csv"},
        {"model.toml", "--sweep", "5:50", "--force", "z=much", "-o", "out.csv"},
        {"model.toml", "--sweep", "5:50", "--base-acceleration", "z=1", "-o", "nowhere/out.csv"},
        {"model.toml", "--from-csv", "nowhere.csv", "-o", "out.csv"},
        {"model.toml", "--sweep", "5:50", "--base-acceleration", "z=1", "--noise", "displacement=-1", "-o", "out.csv"},
    };
    for (const auto& arguments : simulations) calls.emplace_back(SIMULATE_PROGRAM, arguments);
#endif
    for (const auto& [program, arguments] : calls) {
        const auto result = runProgram(program, arguments, folder.path());
        CAPTURE(program, arguments, result.output, result.errors);
        CHECK(result.exit_status == 2);
        CHECK(!result.errors.empty());
        CHECK(folder.list() == before);
    }
}

TEST_CASE("Help is given with status 0 and shows an example") {
    const TemporaryDirectory folder;
    for (const char* command : {"rigidity", "fit", "surface", "compare", "diagnose", "inspect", "convert", "merge"}) {
        const auto result = runProgram(IDENTIFY_PROGRAM, {command, "--help"}, folder.path());
        CAPTURE(command, result.output, result.errors);
        CHECK(result.exit_status == 0);
        CHECK_THAT(result.output, Catch::Contains(std::string("identify ") + command));
    }
}
