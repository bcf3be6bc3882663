#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <limits>
#include <random>

#include "models/common/error.hpp"
#include "models/recording/csv_reader.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/recording/recording_writer.hpp"
#include "tests/recording/temporary_file.hpp"

using namespace wems;

namespace {

/// Channels of every quantity and unit, values over many decades.
Recording makeRandomRecording(std::mt19937& random) {
    Recording recording;
    recording.metadata = {{"test", "random: any"}, {"level", "200 N"}};
    const std::vector<std::pair<const char*, const char*>> channels = {
        {"mobile.1.x", "mm"},   {"mobile.upper, left.vy", "in/s"},
        {"fixed.1.az", "g"},    {"load.fz", "kip"},
        {"relative.1.z", "um"}, {"force.1.z", "lbf"},
        {"base.ax", ""},        {"fixed.2.x", "in"}};
    const auto count = 1 + random() % 300;
    std::uniform_real_distribution<> mantissa(-1, 1), exponent(-9, 4);
    double time = mantissa(random);
    for (std::size_t i = 0; i < count; ++i) {
        recording.time.push_back(time);
        time += random() % 2 == 0 ? 1e-3 : 2e-3;
    }
    int column = 1;
    for (const auto& [name, unit] : channels) {
        Channel channel{name, unit, {}, ++column};
        for (std::size_t i = 0; i < count; ++i)
            channel.values.push_back(random() % 20 == 0 ? 0 : mantissa(random) * std::pow(10, exponent(random)));
        recording.channels.push_back(std::move(channel));
    }
    return recording;
}

/// The same table as a spreadsheet would export it.
std::string toDialect(const std::string& text, int dialect) {
    if (dialect == 0) return text;
    std::string changed = dialect == 3 ? "\xEF\xBB\xBF" : "";
    bool metadata = false, quoted = false, line_start = true;
    for (const char c : text) {
        if (line_start) metadata = c == '#';
        line_start = c == '\n';
        if (c == '"') quoted = !quoted;
        const bool kept = metadata || quoted;
        if (!kept && c == ',') {
            changed += dialect == 1 ? ';' : dialect == 2 ? '\t' : ',';
        } else if (!kept && c == '\n') {
            changed += dialect == 3 ? ",\r\n" : "\r\n";
        } else {
            changed += c;
        }
    }
    if (dialect == 1) {
        const auto body = changed.find('\n', changed.find("time [s]"));
        for (auto i = body; i < changed.size(); ++i) {
            if (changed[i] == '.') changed[i] = ',';
        }
    }
    return changed + (dialect == 3 ? "\r\n\r\n" : "");
}

}  // namespace

TEST_CASE("Random recordings read back equal to the digits printed, in every dialect") {
    const unsigned seed = GENERATE(range(1u, 13u));
    const int dialect = GENERATE(0, 1, 2, 3);
    CAPTURE(seed, dialect);
    std::mt19937 random(seed);
    const Recording recording = makeRandomRecording(random);
    const test::TemporaryFile file;
    writeCsv(recording, file.path(), 9);
    const Recording back = parseRecording(toDialect(file.read(), dialect), "run.csv");
    CHECK(back.metadata == recording.metadata);
    REQUIRE(back.sampleCount() == recording.sampleCount());
    REQUIRE(back.channels.size() == recording.channels.size());
    for (std::size_t i = 0; i < recording.time.size(); ++i)
        REQUIRE(back.time[i] == Approx(recording.time[i]).epsilon(1e-11).margin(0));
    for (std::size_t j = 0; j < recording.channels.size(); ++j) {
        CHECK(back.channels[j].name == recording.channels[j].name);
        for (std::size_t i = 0; i < recording.time.size(); ++i) {
            // Half a unit of the ninth digit is at most 5e-9 of the value.
            const double value = recording.channels[j].values[i];
            REQUIRE(std::abs(back.channels[j].values[i] - value) <= 5.0001e-9 * std::abs(value));
        }
    }
    // What is printed is read and printed again without any change.
    const test::TemporaryFile again;
    writeCsv(back, again.path(), 9);
    if (dialect == 0) CHECK(again.read() == file.read());
}

TEST_CASE("With 17 digits in SI units nothing is lost") {
    std::mt19937 random(7);
    Recording recording = makeRandomRecording(random);
    for (auto& channel : recording.channels) channel.unit.clear();
    const test::TemporaryFile file;
    writeCsv(recording, file.path(), 17);
    const Recording back = readRecording(file.path());
    CHECK(back.time == recording.time);
    for (std::size_t j = 0; j < recording.channels.size(); ++j)
        CHECK(back.channels[j].values == recording.channels[j].values);
}

TEST_CASE("The text itself") {
    Recording recording;
    recording.metadata["note"] = "two\nlines";
    recording.time = {0, 0.5, 1};
    recording.channels = {{"mobile.1.x", "mm", {1e-3, std::nan(""), -2.5e-3}, 0}, {"load.fz", "", {0, 1e6, 1e-7}, 0}};
    const test::TemporaryFile file;
    writeCsv(recording, file.path());
    CHECK(file.read() ==
          "# note: two lines\ntime [s],mobile.1.x [mm],load.fz [N]\n0,1,0\n0.5,,1000000\n1,-2.5,1e-07\n");
}

TEST_CASE("What cannot be written leaves the older file as it was") {
    const test::TemporaryFile file("older");
    Recording recording;
    recording.time = {0, 1};
    recording.channels = {{"mobile.1.x", "mm", {1, 2}, 0}};
    SECTION("unknown unit") {
        recording.channels[0].unit = "furlong";
        CHECK_THROWS_AS(writeCsv(recording, file.path()), InputError);
    }
    SECTION("lengths differ") {
        recording.channels[0].values.push_back(3);
        CHECK_THROWS_AS(writeCsv(recording, file.path()), std::invalid_argument);
    }
    SECTION("infinite value, found halfway") {
        recording.channels[0].values[1] = std::numeric_limits<double>::infinity();
        CHECK_THROWS_AS(writeCsv(recording, file.path()), std::invalid_argument);
    }
    CHECK(file.read() == "older");
    for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(file.path()).parent_path()))
        CHECK(entry.path().string().find(file.path() + ".part") == std::string::npos);
}

TEST_CASE("A folder that is not there") {
    CHECK_THROWS_AS(writeCsv({}, "/no/such/folder/run.csv"), InputError);
}
