// Recordings and models that once ended in a crash or were wrong without a word, through the commands that they ended.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "models/common/error.hpp"
#include "models/recording/recording_reader.hpp"
#include "run_program.hpp"

using Catch::Contains;
using wems::test::runProgram;
using wems::test::TemporaryDirectory;

namespace {

using Words = std::vector<std::string>;

std::string makeModel(const std::string& stiffness) {
    std::string text = "[body]\nmass = 8.0\ninertia = [0.125, 0.125, 0.03]\n";
    for (const auto& [name, place] : {std::pair("1", "[-0.1, 0.0, 0.0]"), std::pair("2", "[0.1, 0.0, 0.0]"),
                                      std::pair("3", "[0.0, -0.1, 0.0]"), std::pair("4", "[0.0, 0.1, 0.0]")})
        for (const std::string& part :
             {std::string("[[connection]]\nname = \"") + name + "\"\nposition = " + place + "\n",
              "[connection.x]\nstiffness = " + stiffness + "\n[connection.y]\nstiffness = " + stiffness + "\n",
              "[connection.z]\nstiffness = " + stiffness + "\n"})
            text += part;
    return text;
}

/// A slow heave of both parts.
std::string makeRun(int rows, double interval, const std::string& strange = "") {
    std::string text = "time [s]";
    for (const char* name : {"1", "2", "3", "4"})
        for (const char* part : {"mobile.", "fixed."})
            for (const char* axis : {"x", "y", "z"}) text += std::string(",") + part + name + "." + axis + " [m]";
    for (int k = 0; k < rows; ++k) {
        text += "\n" + std::to_string(interval * k);
        for (int c = 0; c < 24; ++c)
            text += "," + (k == rows / 2 && c == 4 && !strange.empty()
                               ? strange
                               : std::to_string(c % 3 == 2 ? 1e-3 * std::sin(0.2 * k) * (c % 6 == 2 ? 2 : 1) : 0.0));
    }
    return text + "\n";
}

void checkRefused(const std::string& recording, const std::string& model, const std::string& said,
                  const Words& commands = {"fit", "diagnose"}) {
    for (const std::string& command : commands) {
        const TemporaryDirectory folder;
        folder.write("run.csv", recording);
        folder.write("model.toml", model);
        const auto shown = runProgram(
            IDENTIFY_PROGRAM,
            {command, "run.csv", "--model", "model.toml", "--json", "out.json", "--report", "out.html"}, folder.path());
        CAPTURE(command, shown.output, shown.errors);
        CHECK(shown.exit_status == 2);
        CHECK(std::count(shown.errors.begin(), shown.errors.end(), '\n') == 1);
        CHECK_THAT(shown.errors, Catch::StartsWith("identify: ") && Contains(said));
        CHECK(folder.list() == Words{"model.toml", "run.csv"});
    }
}

}  // namespace

TEST_CASE("Odd recordings and models are refused with one line that says why") {
    const std::string model = makeModel("1.0e5");
    for (const int rows : {1, 2, 7})
        checkRefused(makeRun(rows, 1e-3), model, "only " + std::to_string(rows) + " samples (accepted: at least 8)",
                     {"fit", "diagnose", "rigidity"});
    checkRefused(makeRun(500, 1e-3), makeModel("0.0"), "model.toml: connection: every stiffness is 0");
    checkRefused(makeRun(500, 1), model, "the sample rate of 1 Hz is below twice the lowest natural frequency");
    checkRefused(makeRun(500, 1e-3, "1e308"), model, "run.csv:252: fixed.1.y: the value is 1e+308 in SI",
                 {"fit", "diagnose", "rigidity", "inspect"});
    std::string deep = model;
    for (int i = 0; i < 50000; ++i) deep += "a.";
    checkRefused(makeRun(500, 1e-3), deep + "a = 1\n", "a key has more than 64 parts", {"fit", "inspect"});
}

TEST_CASE("Tables of OpenSim: rows that the header declares are counted, a cut last number is said") {
    const TemporaryDirectory folder;
    const std::string header = "run\nDataType=double\nversion=3\nunits=SI\nnRows=3\nendheader\ntime\tmobile.1.z\n";
    const std::string rows = "0\t0.125\n0.001\t0.25\n0.002\t0.375\n";
    folder.write("run.sto", header + rows);
    CHECK(wems::readRecording(folder.path() + "/run.sto").warnings.empty());
    // Cut anywhere within the samples: refused, or said.
    for (std::size_t length = 1; length < rows.size(); ++length) {
        folder.write("run.sto", header + rows.substr(0, length));
        CAPTURE(rows.substr(0, length));
        try {
            const auto warnings = wems::readRecording(folder.path() + "/run.sto").warnings;
            CHECK(std::any_of(warnings.begin(), warnings.end(), [](const std::string& warning) {
                return warning.find("its last number may lack digits") != std::string::npos;
            }));
        } catch (const wems::InputError&) {
        }
    }
    folder.write("run.mot", "name run\ndatacolumns 2\ndatarows 4\nendheader\ntime\tmobile.1.z\n" + rows);
    CHECK_THROWS_WITH(wems::readRecording(folder.path() + "/run.mot"),
                      Contains("the file ends after 3 rows, its header declares 4"));
}

TEST_CASE("Displacements that no rigid part makes are refused by what would tell rotations from them") {
    // A heave of a kilometre is a rigid motion of a part 0.2 m wide; one connection alone that far away is none.
    std::string far = makeRun(500, 1e-3, "1000");
    checkRefused(
        far, makeModel("1.0e5"),
        "run.csv:252: fixed.2.y: has moved 1e+03 m against fixed.1.y, points of a rigid part 0.2 m wide at most "
        "0.4 m");
}

TEST_CASE("A component test whose displacement is clipped to two levels is answered or refused, and says why") {
    // Found by a fuzzer: strokes without any travel on them.
    for (const double level : {4e-8, 1e-6, 1e-4}) {
        std::string text = "time [s],relative.1.z [m],force.1.z [N]\n";
        for (int k = 0; k < 400; ++k) {
            const double t = 2e-3 * k, q = 2e-3 * std::sin(20 * t) * t;
            const double force = 1e5 * q + (q > 1e-3 ? 1e6 * (q - 1e-3) : 0.0) + 5 * std::sin(977.0 * k);
            char row[80];
            std::snprintf(row, sizeof row, "%.9g,%.9g,%.9g\n", t, std::clamp(q, -level, level), force);
            text += row;
        }
        const TemporaryDirectory folder;
        folder.write("run.csv", text);
        const auto shown = runProgram(IDENTIFY_PROGRAM, {"surface", "run.csv", "--json", "out.json"}, folder.path());
        CAPTURE(level, shown.output, shown.errors);
        CHECK((shown.exit_status == 0 || shown.exit_status == 2));
        CHECK_THAT(shown.errors, !Contains("internal"));
        CHECK(folder.list().size() == (shown.exit_status == 0 ? 2 : 1));
    }
}
