// What the commands write: never over what they read, all of it or nothing, through links and pipes, and errors of
// standard output noticed.
#include <sys/stat.h>
#include <sys/wait.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "run_program.hpp"

using Catch::Contains;
using wems::test::runProgram;
using wems::test::TemporaryDirectory;
namespace fs = std::filesystem;

namespace {

/// A spring of 100 N/mm on a test machine.
std::string makeComponentTest() {
    std::string text = "time [s],relative.1.z [mm],force.1.z [N]\n";
    for (int k = 0; k < 200; ++k) {
        const double q = std::sin(0.1 * k);
        text += std::to_string(1e-3 * k) + "," + std::to_string(q) + "," + std::to_string(100 * q) + "\n";
    }
    return text;
}

const std::string component_test = makeComponentTest();
const char* const model =
    "[body]\nmass = 1.0\ninertia = [1.0, 1.0, 1.0]\n[[connection]]\nname = \"1\"\nposition = [0.0, 0.0, "
    "0.0]\n[connection.z]\nstiffness = 1.0e5\n";
const char* const campaign = "model = \"model.toml\"\n[[run]]\nfile = \"run.csv\"\nrole = \"identify\"\n";

std::string read(const TemporaryDirectory& folder, const std::string& name) {
    std::ifstream file(folder.path() + "/" + name);
    return {std::istreambuf_iterator<char>(file), {}};
}

void writeInputs(const TemporaryDirectory& folder) {
    folder.write("run.csv", component_test);
    folder.write("model.toml", model);
    folder.write("campaign.toml", campaign);
    fs::create_symlink("run.csv", folder.path() + "/link.csv");
}

using Words = std::vector<std::string>;

/// The command in a shell, with what is done to standard output; what it says on standard error.
int runRedirected(const TemporaryDirectory& folder, const std::string& program, const std::string& arguments,
                  const std::string& redirection, std::string& errors) {
    const std::string command =
        "cd '" + folder.path() + "' && { { '" + program + "' " + arguments + " 2>errors; } " + redirection + "; }";
    const int status = std::system(command.c_str());
    errors = read(folder, "errors");
    fs::remove(folder.path() + "/errors");
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

TEST_CASE("An output that is an input or another output is refused, and nothing is touched") {
    const Words fit{"fit", "run.csv", "--model", "model.toml"};
    for (const Words& outputs : std::vector<Words>{{"-o", "run.csv"},
                                                   {"-o", "./run.csv"},
                                                   {"-o", "link.csv"},
                                                   {"-o", "model.toml"},
                                                   {"--json", "run.csv"},
                                                   {"--report", "link.csv"},
                                                   {"-o", "new.toml", "--json", "new.toml"},
                                                   {"--json", "new", "--report", "./new"}}) {
        const TemporaryDirectory folder;
        writeInputs(folder);
        const auto before = folder.list();
        Words arguments = fit;
        arguments.insert(arguments.end(), outputs.begin(), outputs.end());
        const auto shown = runProgram(IDENTIFY_PROGRAM, arguments, folder.path());
        CAPTURE(outputs, shown.errors);
        CHECK(shown.exit_status == 2);
        CHECK(std::count(shown.errors.begin(), shown.errors.end(), '\n') == 1);
        CHECK_THAT(shown.errors, Contains("accepted: another name for the output"));
        CHECK(read(folder, "run.csv") == component_test);
        CHECK(read(folder, "model.toml") == model);
        CHECK(folder.list() == before);
    }
}

TEST_CASE("A run of a test file is an input, too") {
    const TemporaryDirectory folder;
    writeInputs(folder);
    const auto shown = runProgram(IDENTIFY_PROGRAM, {"fit", "--test", "campaign.toml", "-o", "run.csv"}, folder.path());
    CAPTURE(shown.errors);
    CHECK(shown.exit_status == 2);
    CHECK_THAT(shown.errors, Contains("run.csv: is read and to be written"));
    CHECK(read(folder, "run.csv") == component_test);
}

TEST_CASE("Standard output that is full, closed or not read: one line, status 2, no file") {
    const TemporaryDirectory folder;
    writeInputs(folder);
    const auto before = folder.list();
    const std::string fit = "fit run.csv --model model.toml -o fitted.toml";
    for (const std::string& arguments : {fit, fit + " --json -", std::string("--help"), std::string("--version")}) {
        for (const char* redirection : {">/dev/full", ">&-"}) {
            std::string errors;
            const int status = runRedirected(folder, IDENTIFY_PROGRAM, arguments, redirection, errors);
            CAPTURE(arguments, redirection, errors);
            CHECK(status == 2);
            CHECK(std::count(errors.begin(), errors.end(), '\n') == 1);
            CHECK_THAT(errors, Contains("standard output: could not be written completely"));
            CHECK(folder.list() == before);
        }
    }
    std::string errors;
    CHECK(runRedirected(folder, IDENTIFY_PROGRAM, fit + " -q", ">&-", errors) == 0);  // nothing to print
    CHECK_THAT(read(folder, "fitted.toml"), Contains("stiffness"));
}

TEST_CASE("All outputs of a command or none: an output that fails takes the others with it") {
    const TemporaryDirectory folder;
    writeInputs(folder);
    const auto before = folder.list();
    for (const char* full : {"--json", "--report", "-o"}) {
        Words arguments{"fit", "run.csv", "--model", "model.toml"};
        for (const auto& [option, name] :
             {std::pair("--json", "fit.json"), std::pair("--report", "fit.html"), std::pair("-o", "fitted.toml")})
            arguments.insert(arguments.end(), {option, option == std::string(full) ? "/dev/full" : name});
        const auto shown = runProgram(IDENTIFY_PROGRAM, arguments, folder.path());
        CAPTURE(full, shown.errors);
        CHECK(shown.exit_status == 2);
        CHECK_THAT(shown.errors, Contains("/dev/full: could not be written completely"));
        CHECK(std::count(shown.errors.begin(), shown.errors.end(), '\n') == 1);
        CHECK(folder.list() == before);
    }
}

TEST_CASE("A pipe is written through, a link and a mode are kept") {
    const TemporaryDirectory folder;
    writeInputs(folder);
    REQUIRE(mkfifo((folder.path() + "/pipe").c_str(), 0600) == 0);
    folder.write("target.toml", "older");
    REQUIRE(chmod((folder.path() + "/target.toml").c_str(), 0600) == 0);
    fs::create_symlink("target.toml", folder.path() + "/fitted.toml");
    std::string errors;
    const int status =
        runRedirected(folder, IDENTIFY_PROGRAM, "fit run.csv --model model.toml -q --json pipe -o fitted.toml",
                      "& timeout 20 cat pipe >received; wait $!", errors);
    CAPTURE(errors);
    CHECK(status == 0);
    CHECK_THAT(read(folder, "received"), Contains("\"parameters\""));
    CHECK(fs::is_fifo(folder.path() + "/pipe"));
    CHECK(fs::is_symlink(folder.path() + "/fitted.toml"));
    CHECK_THAT(read(folder, "target.toml"), Contains("stiffness"));
    CHECK((fs::status(folder.path() + "/target.toml").permissions() & fs::perms::mask) == fs::perms(0600));
}

#ifdef SIMULATE_PROGRAM
TEST_CASE("simulate: the replayed recording and the model are not written over; standard output counts") {
    const TemporaryDirectory folder;
    const std::string device = WEMS_SOURCE_DIR "/models/shipped/single_axis.toml";
    fs::copy_file(device, folder.path() + "/device.toml");
    const Words dwell{"device.toml", "--dwell", "10:0.1", "--base-acceleration", "z=1"};
    const auto simulate = [&](Words arguments, const Words& more) {
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runProgram(SIMULATE_PROGRAM, arguments, folder.path());
    };
    const auto first = simulate(dwell, {"-q", "-o", "run.csv"});
    CAPTURE(first.errors);
    REQUIRE(first.exit_status == 0);
    const std::string run = read(folder, "run.csv");
    for (const auto& shown :
         {simulate({"device.toml", "--from-csv", "run.csv"}, {"-o", "run.csv"}), simulate(dwell, {"-o", "device.toml"}),
          simulate(dwell, {"-o", "a.csv", "--report", "a.csv"})}) {
        CAPTURE(shown.errors);
        CHECK(shown.exit_status == 2);
        CHECK_THAT(shown.errors, Contains("another name for the output"));
    }
    CHECK(read(folder, "run.csv") == run);
    std::string errors;
    const int status =
        runRedirected(folder, SIMULATE_PROGRAM, "device.toml --dwell 10:0.1 --base-acceleration z=1 -o b.csv --json -",
                      ">/dev/full", errors);
    CAPTURE(errors);
    CHECK(status == 2);
    CHECK_THAT(errors, Contains("standard output: could not be written completely"));
    CHECK(folder.list() == Words{"device.toml", "run.csv"});
}
#endif
