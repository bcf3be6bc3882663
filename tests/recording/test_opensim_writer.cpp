#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <random>

#include "models/common/error.hpp"
#include "models/recording/opensim_writer.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/recording/recording_writer.hpp"
#include "tests/recording/temporary_file.hpp"

using namespace wems;
using Catch::Contains;

namespace {

/// Random values of channels of every part; the first sample is at rest.
Recording makeRun(unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    Recording run;
    run.metadata = {{"program", "test"}, {"level", "200 N\n(low)"}};
    for (int i = 0; i < 50; ++i) run.time.push_back(0.25 + 0.001 * i);
    for (const char* name : {"mobile.1.x", "mobile.1.y", "mobile.1.z", "fixed.arm 2.z", "mobile.1.az", "load.fz"}) {
        Channel channel{name, "", {}, 0};
        for (int i = 0; i < 50; ++i) channel.values.push_back(i == 0 ? 0 : 1e-3 * normal(random));
        run.channels.push_back(channel);
    }
    return run;
}

/// A folder that goes with the object, for names with extensions.
struct Folder {
    std::string path;
    explicit Folder(const test::TemporaryFile& unique) : path(unique.path() + ".d") {
        std::filesystem::create_directory(path);
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
};

void checkSame(const Recording& a, const Recording& b, const std::string& name, double tolerance) {
    INFO(name);
    REQUIRE(a.find(name) != nullptr);
    REQUIRE(b.find(name) != nullptr);
    for (std::size_t i = 0; i < a.time.size(); ++i)
        CHECK(a.find(name)->values[i] == Approx(b.find(name)->values[i]).margin(tolerance).epsilon(0));
}

}  // namespace

TEST_CASE("A table for OpenSim reads back channel by channel") {
    const test::TemporaryFile unique;
    const Folder folder(unique);
    const Recording run = makeRun(5);
    const std::string file = folder.path + "/run.sto";
    CHECK(writeRecording(run, file, {17, {}}).empty());
    const Recording back = readRecording(file);
    CHECK(back.format == "OpenSim .sto");
    CHECK(back.time == run.time);
    CHECK(back.warnings.empty());
    CHECK(back.metadata.at("level") == "200 N (low)");
    for (const auto& channel : run.channels) checkSame(back, run, channel.name, 0);
}

TEST_CASE("Markers for OpenSim stand where the connections are and read back as displacements") {
    const test::TemporaryFile unique;
    const Folder folder(unique);
    const Recording run = makeRun(6);
    const std::string file = folder.path + "/run.trc";
    const auto notes = writeRecording(run, file, {12, {{"1", {-0.1, 0.02, 0.3}}}});
    REQUIRE(notes.size() == 1);
    CHECK_THAT(notes.front(), Contains("2 channels are left out (mobile.1.az"));
    const Recording back = readRecording(file);
    REQUIRE(back.time.size() == run.time.size());
    for (std::size_t i = 0; i < run.time.size(); ++i) CHECK(back.time[i] == Approx(run.time[i]).epsilon(1e-11));
    for (const char* name : {"mobile.1.x", "mobile.1.y", "mobile.1.z", "fixed.arm 2.z"})
        checkSame(back, run, name, 1e-14);
    CHECK(back.channels.size() == 4);
    const ColumnMap map =
        parseColumnMap("[columns]\n\"mobile.1.x\" = \"mobile.1.x\"\n[table]\nrest = \"none\"\n", "map");
    CHECK(readRecording(file, &map).find("mobile.1.x")->values.front() == Approx(-0.1));
}

TEST_CASE("What cannot be written is refused, and leaves no file") {
    const test::TemporaryFile unique;
    const Folder folder(unique);
    Recording run = makeRun(7);
    CHECK_THROWS_WITH(writeRecording(run, folder.path + "/run.mat"), Contains(".mat is not written"));
    run.channels.erase(run.channels.begin(), run.channels.begin() + 4);
    CHECK_THROWS_WITH(writeRecording(run, folder.path + "/run.trc"), Contains("no displacements"));
    run.channels.front().values[3] = HUGE_VAL;
    CHECK_THROWS_AS(writeRecording(run, folder.path + "/run.sto"), std::invalid_argument);
    CHECK(std::filesystem::is_empty(folder.path));
}
