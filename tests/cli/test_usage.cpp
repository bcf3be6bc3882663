// Command lines that cannot be used: one line that says why, exit status 2, before anything is read or written.
#include <algorithm>
#include <catch2/catch.hpp>

#include "run_program.hpp"

using Catch::Contains;
using wems::test::runProgram;
using wems::test::TemporaryDirectory;

namespace {

void checkRefused(const std::vector<std::string>& arguments, const std::vector<std::string>& said) {
    const TemporaryDirectory folder;
    folder.write("run.csv", "# rate: 1000\ntime [s],mobile.1.z [mm],fixed.1.z [mm]\n0,0,0\n0.001,1,0\n");
    const auto shown = runProgram(IDENTIFY_PROGRAM, arguments, folder.path());
    CAPTURE(shown.output, shown.errors);
    CHECK(shown.exit_status == 2);
    CHECK(shown.output.empty());
    CHECK(std::count(shown.errors.begin(), shown.errors.end(), '\n') == 1);
    CHECK(shown.errors.size() < 250);
    CHECK_THAT(shown.errors, Catch::StartsWith("identify: "));
    for (const auto& part : said) CHECK_THAT(shown.errors, Contains(part));
    CHECK(folder.list() == std::vector<std::string>{"run.csv"});
}

}  // namespace

TEST_CASE("A command that there is not is named, with those that there are") {
    checkRefused({"fitt", "run.csv"}, {"'fitt' is not a command", "accepted: convert, merge, inspect", "diagnose"});
    checkRefused({}, {"no command is given", "rigidity"});
}

TEST_CASE("A wrong option is named, with the help that lists the right ones") {
    checkRefused({"fit", "run.csv", "--modle", "m.toml"}, {"--modle", "identify fit --help"});
    checkRefused({"rigidity", "run.csv"}, {"--model is required", "identify rigidity --help"});
    checkRefused({"inspect", "run.csv", "--json"}, {"--json", "identify inspect --help"});
    checkRefused({"surface", "run.csv", "--axis", "w"}, {"--axis", "w", "{x,y,z}"});
}

TEST_CASE("A number out of its range is said in few words") {
    checkRefused({"compare", "run.csv", "run.csv", "--limit", "5%"}, {"--limit", "'5%' is not a number above 0"});
    checkRefused({"compare", "run.csv", "run.csv", "--limit", "nan"}, {"'nan' is not a number above 0"});
    checkRefused({"rigidity", "run.csv", "--model", "m.toml", "--limit", "-1"}, {"'-1' is not a number from 0 on"});
}

TEST_CASE("An output that cannot be written is said before anything is read") {
    for (const char* option : {"--json", "--report", "-o"})
        checkRefused({"fit", "not_there.csv", "--model", "not_there.toml", option, "no_folder/out"},
                     {"no_folder/out: cannot be written", "accepted: a file in a folder"});
    checkRefused({"fit", "not_there.csv", "--model", "not_there.toml", "-o", "."}, {".: is a folder"});
}

TEST_CASE("A recording in place of a model is recognised") {
    checkRefused({"fit", "run.csv", "--model", "run.csv"},
                 {"run.csv:2", "not valid TOML", "looks like a table of data, such as a recording"});
}

TEST_CASE("A window that ends before it begins is refused before anything is read") {
    checkRefused({"surface", "not_there.csv", "--from", "2", "--to", "1"},
                 {"--from/--to", "the window ends before it begins", "--from below --to"});
}

TEST_CASE("A model in place of a recording is recognised") {
    const TemporaryDirectory folder;
    folder.write("model.toml", "[body]\nmass = 5.0\n");
    const auto shown = runProgram(IDENTIFY_PROGRAM, {"inspect", "model.toml"}, folder.path());
    CAPTURE(shown.output, shown.errors);
    CHECK(shown.exit_status == 2);
    CHECK_THAT(shown.errors, Contains("model.toml: a TOML file where a recording is expected"));
}
