// Recordings of other programs and laboratories; skipped where the environment does not name their folder.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>

#include "models/recording/column_map.hpp"
#include "models/recording/recording_reader.hpp"

using namespace wems;

namespace {

std::vector<std::string> listFiles(const std::string& folder, const std::string& start) {
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const auto name = entry.path().filename().string();
        if (entry.path().extension() == ".csv" && name.compare(0, start.size(), start) == 0)
            files.push_back(entry.path().string());
    }
    return files;
}

}  // namespace

TEST_CASE("Other laboratories' files are read through column maps") {
    const char* folder = std::getenv("WEMS_MEASURED_DATA");
    if (folder == nullptr) {
        WARN("skipped: WEMS_MEASURED_DATA is not set");
        return;
    }
    SECTION("CyberDiver: clips at 16 g") {
        const auto map = parseColumnMap(
            "[columns]\n\"t [s]\" = \"time\"\n\"position [mm]\" = \"relative.1.y\"\n\"coil force\" = \"force.1.y\"\n"
            "\"accel x [g]\" = \"mobile.1.ax\"\n\"accel y [g]\" = \"mobile.1.ay\"\n\"accel z [g]\" = \"mobile.1.az\"\n",
            "map.toml");
        for (const auto& file : listFiles(std::string(folder) + "/cyberdiver", "15n")) {
            INFO(file);
            const auto recording = readRecording(file, &map);
            CHECK(recording.channels.size() == 5);
            CHECK(recording.sampleInterval() == Approx(1.0 / 25000).epsilon(1e-6));
            REQUIRE(recording.warnings.size() == 1);
            CHECK_THAT(recording.warnings[0],
                       Catch::StartsWith("mobile.1.ay: clipped: stays at its smallest value -156.9"));
        }
    }
    SECTION("CyberDiver static: no time, no units, trials of different length") {
        const auto map = parseColumnMap(
            "[columns]\n\"Trial 3_x\" = { channel = \"relative.1.y\", unit = \"mm\" }\n"
            "\"Trial 3_y\" = { channel = \"force.1.y\", unit = \"N\" }\n[table]\ntime = \"none\"\n",
            "map.toml");
        const auto recording =
            readRecording(std::string(folder) + "/cyberdiver/static_force_test_5n_threshold.csv", &map);
        CHECK(recording.time[5] == 5.0);
        CHECK(recording.channels.size() == 2);
        REQUIRE(recording.warnings.size() == 1);
        CHECK_THAT(recording.warnings[0], Catch::Contains("no values in the last 5 rows (from row 1131)"));
    }
    SECTION("friction damper") {
        const auto map = parseColumnMap(
            "[columns]\n\"Time (s)\" = \"time\"\n\"Displacement (in)\" = \"relative.1.x\"\n"
            "\"Friction Force\" = \"force.1.x\"\n",
            "map.toml");
        for (const auto& file : listFiles(std::string(folder) + "/friction_backlash", "0p")) {
            INFO(file);
            const auto recording = readRecording(file, &map);
            CHECK(recording.sampleInterval() == Approx(1.0 / 1024).epsilon(1e-6));
            CHECK(recording.unused_columns.size() == 3);
            CHECK(recording.warnings.empty());
        }
    }
}
