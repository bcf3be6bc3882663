// What a user sees of a model that cannot be used: one line with file, line and key, exit status 2, and no file.
#include <algorithm>
#include <catch2/catch.hpp>

#include "run_program.hpp"

using wems::test::runProgram;
using wems::test::TemporaryDirectory;

namespace {

const char* const good_model = R"(name = "one"
[body]
mass = 8.0
inertia = [0.12, 0.12, 0.03]
[[connection]]
name = "1"
position = [-0.1, 0.0, 0.0]
[connection.x]
stiffness = 2.6e4
[connection.z]
stiffness = 1.0e5
stops = [ { side = "+", clearance = 1.6e-3, stiffness = 1.32e6 } ]
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

struct Case {
    const char* what;
    const char* from;
    const char* to;
    std::vector<std::string> message;  ///< parts that the message must have
};

}  // namespace

TEST_CASE("A model that cannot be used is refused in one line by simulate and identify") {
    const auto c = GENERATE(values<Case>({
        {"unknown key", "mass = 8.0", "mass = 8.0\nweight = 80.0", {"model.toml:4", "weight"}},
        {"unknown key of an axis",
         "stiffness = 1.0e5",
         "stiffness = 1.0e5\nstifness = 1.0",
         {"model.toml:12", "stifness"}},
        {"missing mass", "mass = 8.0\n", "", {"model.toml", "mass"}},
        {"missing stiffness", "[connection.x]\nstiffness = 2.6e4", "[connection.x]", {"model.toml", "stiffness"}},
        {"missing clearance", "clearance = 1.6e-3, ", "", {"model.toml:12", "clearance"}},
        {"negative mass", "mass = 8.0", "mass = -8.0", {"model.toml:3", "mass", "-8"}},
        {"negative clearance", "clearance = 1.6e-3", "clearance = -1.6e-3", {"model.toml:12", "clearance", "-0.0016"}},
        {"not a number", "mass = 8.0", "mass = nan", {"model.toml:3", "mass"}},
        {"infinite", "stiffness = 1.0e5", "stiffness = inf", {"model.toml:11", "stiffness"}},
        {"text for a number", "mass = 8.0", "mass = \"8 kg\"", {"model.toml:3", "mass"}},
        {"wrong side", "side = \"+\"", "side = \"up\"", {"model.toml:12", "side"}},
        {"not TOML", "mass = 8.0", "mass = = 8.0", {"model.toml:3"}},
        {"two numbers for a position", "[-0.1, 0.0, 0.0]", "[-0.1, 0.0]", {"model.toml:7", "position"}},
        {"inertia of no body", "[0.12, 0.12, 0.03]", "[0.12, 0.12, 0.3]", {"model.toml:4", "inertia"}},
        {"no such modes file",
         "name = \"one\"",
         "name = \"one\"\nbracket = { modes = \"nowhere.csv\" }",
         {"nowhere.csv"}},
    }));
    CAPTURE(c.what);
    const TemporaryDirectory folder;
    folder.write("model.toml", replaced(good_model, c.from, c.to));
    folder.write("run.csv", "time [s],mobile.1.x [m],mobile.1.y [m],mobile.1.z [m]\n0,0,0,0\n0.001,0,0,0\n");
    const auto before = folder.list();

    const std::vector<std::pair<std::string, std::vector<std::string>>> calls = {
#ifdef SIMULATE_PROGRAM
        {SIMULATE_PROGRAM, {"model.toml", "--sweep", "5:50", "--rate", "4", "--force", "z=200", "-o", "out.csv"}},
#endif
        {IDENTIFY_PROGRAM, {"fit", "run.csv", "--model", "model.toml", "-o", "out.toml", "--json", "out.json"}},
    };
    for (const auto& [program, arguments] : calls) {
        const auto result = runProgram(program, arguments, folder.path());
        CAPTURE(program, result.output, result.errors);
        CHECK(result.exit_status == 2);
        CHECK(std::count(result.errors.begin(), result.errors.end(), '\n') == 1);
        for (const auto& part : c.message) CHECK_THAT(result.errors, Catch::Contains(part));
        CHECK(folder.list() == before);
    }
}
