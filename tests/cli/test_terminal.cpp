// What the commands look like on a terminal, through a pipe, with --quiet and with --json -; completion in bash.
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "run_program.hpp"

using Catch::Contains;
using wems::test::runProgram;
using wems::test::TemporaryDirectory;

namespace {

const char* const component_test =
    "time [s],relative.1.z [mm],force.1.z [N]\n"
    "0,0,0\n0.001,0.1,10\n0.002,0.2,20\n0.003,0.1,10\n0.004,0,0\n0.005,-0.1,-10\n0.006,-0.2,-20\n0.007,-0.1,-10\n";

/// False, saying so, where the system gives no pseudo-terminal: then there is nothing to look at.
bool hasTerminals() {
    int terminal = -1, other = -1;
    if (openpty(&terminal, &other, nullptr, nullptr, nullptr) != 0) {
        WARN("no pseudo-terminal here: not tested");
        return false;
    }
    close(terminal);
    close(other);
    return true;
}

/// All that `identify` with these arguments writes to a terminal of its own.
std::string runOnTerminal(std::vector<std::string> arguments, const std::string& folder, const char* no_color) {
    int terminal = -1;
    const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
    REQUIRE(child >= 0);
    if (child == 0) {
        setenv("TERM", "xterm", 1);
        setenv("NO_COLOR", no_color, 1);
        arguments.insert(arguments.begin(), IDENTIFY_PROGRAM);
        std::vector<char*> pointers;
        for (auto& argument : arguments) pointers.push_back(argument.data());
        pointers.push_back(nullptr);
        if (chdir(folder.c_str()) == 0) execv(IDENTIFY_PROGRAM, pointers.data());
        _exit(127);
    }
    std::string shown;
    std::array<char, 4096> buffer{};
    for (ssize_t count = 0; (count = read(terminal, buffer.data(), buffer.size())) > 0;)
        shown.append(buffer.data(), count);
    close(terminal);
    int status = 0;
    waitpid(child, &status, 0);
    CHECK(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 0);
    return shown;
}

/// What bash offers for the word at the end of `line`.
std::string complete(const std::string& line, const TemporaryDirectory& folder) {
    const auto script = runProgram(IDENTIFY_PROGRAM, {"--completion", "wems-identify"}, folder.path());
    REQUIRE(script.exit_status == 0);
    folder.write("completion", script.output);
    const auto offered = runProgram("/bin/bash",
                                    {"-c", "source ./completion; COMP_WORDS=(" + line +
                                               "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); "
                                               "_wems_identify; echo \"${COMPREPLY[*]}\""},
                                    folder.path());
    CHECK(offered.errors.empty());
    return offered.output;
}

}  // namespace

TEST_CASE("Tables are coloured on a terminal, unless NO_COLOR is set, and plain in a pipe") {
    if (!hasTerminals()) return;
    const TemporaryDirectory folder;
    folder.write("run.csv", component_test);
    const std::vector<std::string> command{"inspect", "run.csv"};
    CHECK_THAT(runOnTerminal(command, folder.path(), ""), Contains("\033[1mchannel"));
    CHECK_THAT(runOnTerminal(command, folder.path(), "1"), Contains("channel") && !Contains("\033[1m"));
    const auto piped = runProgram(IDENTIFY_PROGRAM, command, folder.path());
    CHECK_THAT(piped.output, Contains("channel") && !Contains("\033"));
    CHECK_THAT(piped.errors, !Contains("reading"));
}

TEST_CASE("Progress is shown on a terminal and taken away again") {
    if (!hasTerminals()) return;
    const TemporaryDirectory folder;
    folder.write("run.csv", component_test);
    const std::string shown = runOnTerminal({"inspect", "run.csv"}, folder.path(), "");
    CHECK_THAT(shown, Contains("reading run.csv"));
    CHECK(shown.find("\r\033[K", shown.find("reading run.csv")) != std::string::npos);
    CHECK_THAT(runOnTerminal({"inspect", "run.csv", "--quiet"}, folder.path(), ""), !Contains("reading"));
}

TEST_CASE("Data and nothing else with --json -, nothing with --quiet") {
    const TemporaryDirectory folder;
    folder.write("run.csv", component_test);
    const auto data = runProgram(IDENTIFY_PROGRAM, {"inspect", "run.csv", "--json", "-"}, folder.path());
    CHECK(data.exit_status == 0);
    CHECK(data.output.front() == '{');
    CHECK(data.output.substr(data.output.size() - 2) == "}\n");
    const auto quiet = runProgram(IDENTIFY_PROGRAM, {"inspect", "run.csv", "-q", "--json", "out.json"}, folder.path());
    CHECK(quiet.exit_status == 0);
    CHECK(quiet.output.empty());
    CHECK(folder.list() == std::vector<std::string>{"out.json", "run.csv"});
}

TEST_CASE("Manual pages are named as they are called for and say what their program does") {
    const auto readPage = [](const std::string& name) {
        std::ifstream file(WEMS_BINARY_DIR "/documents/" + name + ".1");
        return std::string{std::istreambuf_iterator<char>(file), {}};
    };
    const std::string page = readPage("wems-identify-diagnose");
    if (page.empty()) {
        WARN("no help2man here: not tested");
        return;
    }
    CHECK_THAT(page, Contains(".TH WEMS-IDENTIFY-DIAGNOSE \"1\""));
    CHECK_THAT(page, Contains(".SH NAME\nwems-identify-diagnose \\- find what the model lacks or has wrong"));
    CHECK_THAT(readPage("wems-identify"), Contains(".SH NAME\nwems-identify \\- identify mounts"));
}

TEST_CASE("bash completes commands, options and values") {
    const TemporaryDirectory folder;
    CHECK(complete("wems-identify dia", folder) == "diagnose\n");
    CHECK(complete("wems-identify fit --rep", folder) == "--report\n");
    CHECK(complete("wems-identify fit --axis ''", folder) == "x y z\n");
    CHECK(complete("wems-identify fit run", folder) == "\n");  // a file, which bash completes by itself
    CHECK_THAT(complete("wems-identify ''", folder), Contains("rigidity") && Contains("compare"));
}
