// A recording that another program writes anew while a command reads it.
#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include "run_program.hpp"
#include "tests/sanitized.hpp"
#include "tests/seed.hpp"

using wems::test::runProgram;
using wems::test::TemporaryDirectory;

namespace {

/// Some megabytes, so that reading takes a while.
std::string makeLongRecording() {
    constexpr int rows = 60000;
    std::string text = "time [s],relative.1.z [m],relative.1.vz [m/s],force.1.z [N]\n";
    char row[100];
    for (int k = 0; k < rows; ++k) {
        const double t = 1e-3 * k, q = 1e-3 * std::sin(20 * t), v = 2e-2 * std::cos(20 * t);
        std::snprintf(row, sizeof row, "%.6f,%.12e,%.12e,%.12e\n", t, q, v, 1e5 * q + 10 * v);
        text += row;
    }
    return text;
}

}  // namespace

TEST_CASE("A file that shrinks while a command reads it ends the command in one line or not at all") {
    const unsigned seed = wems::test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    const std::string content = makeLongRecording();
    // `--memory` has it read in blocks, from pages of the file itself.
    int refused = 0;
    for (const std::string options : {"", " --memory 1"}) {
        const auto inspect = [&](const TemporaryDirectory& folder, const std::string& meanwhile) {
            folder.write("run.csv", content);
            return runProgram("/bin/sh",
                              {"-c", "'" IDENTIFY_PROGRAM "' inspect run.csv --json out.json" + options +
                                         " >/dev/null & " + meanwhile + " wait $!"},
                              folder.path());
        };
        const auto start = std::chrono::steady_clock::now();
        REQUIRE(inspect(TemporaryDirectory(), "").exit_status == 0);
        const double whole = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        constexpr int trials = wems::test::kSanitized ? 2 : 12;
        for (int trial = 0; trial < trials; ++trial) {
            const TemporaryDirectory folder;
            // Reading is some 15 % of the time, after the program's own start.
            const double moment = whole * std::uniform_real_distribution<double>(0, 0.4)(random);
            const std::string left = std::to_string(random() % content.size());
            const auto shown =
                inspect(folder, "sleep " + std::to_string(moment) + "; truncate -s " + left + " run.csv;");
            CAPTURE(options, trial, moment, left, shown.exit_status, shown.errors);
            REQUIRE((shown.exit_status == 0 || shown.exit_status == 2));
            refused += shown.exit_status == 2 ? 1 : 0;
            if (shown.exit_status == 2) CHECK(std::count(shown.errors.begin(), shown.errors.end(), '\n') == 1);
            const auto files = folder.list();
            CHECK(files.size() == (shown.exit_status == 0 ? 2U : 1U));
        }
    }
    // That of 24 moments none falls into the reading comes once in 50 000 runs.
    if (!wems::test::kSanitized) CHECK(refused >= 1);
}
