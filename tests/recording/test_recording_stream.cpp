// A long recording in blocks: together they are what readRecording() reads at once.
#include <catch2/catch.hpp>
#include <cstdio>
#include <random>

#include "models/common/error.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/recording/recording_stream.hpp"
#include "tests/recording/temporary_file.hpp"
#include "tests/seed.hpp"

using namespace wems;
using Catch::Contains;

namespace {

/// A row for each millisecond, values with nine digits.
std::string makeText(std::size_t rows, std::mt19937& random, const std::string& header = "time [s],mobile.1.z [mm]") {
    std::string text = "# level: 200 N\n" + header + "\n";
    char row[60];
    for (std::size_t k = 0; k < rows; ++k) {
        std::snprintf(row, sizeof row, "%.3f,%.6f\n", 1e-3 * static_cast<double>(k),
                      1e-6 * static_cast<double>(random() % 2000000));
        text += row;
    }
    return text;
}

std::vector<Recording> readBlocks(const std::string& file, std::size_t rows, const ColumnMap* map = nullptr) {
    RecordingStream stream(file, map, rows);
    std::vector<Recording> blocks;
    for (Recording block; stream.next(block);) blocks.push_back(block);
    return blocks;
}

}  // namespace

TEST_CASE("Blocks join to the whole recording") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    const std::size_t samples = 300000 + random() % 100000;  // several of the pieces in which the file is read
    const test::TemporaryFile file(makeText(samples, random) + (random() % 2 == 0 ? "" : "\n\n"));
    REQUIRE(isStreamable(file.path()));
    const Recording whole = readRecording(file.path());
    const std::size_t rows = 1000 + random() % 200000;
    CAPTURE(samples, rows);
    CHECK(RecordingStream(file.path(), nullptr, rows).expectedSamples() == Approx(samples).epsilon(0.02));
    std::size_t next = 0;
    for (const Recording& block : readBlocks(file.path(), rows)) {
        const std::size_t first = next > 0 ? next - 1 : 0, count = block.sampleCount();
        CHECK(block.first_row == whole.first_row + static_cast<long>(first));
        CHECK(count <= rows + rows / 2);
        REQUIRE(first + count <= samples);
        const auto begin = static_cast<std::ptrdiff_t>(first), end = static_cast<std::ptrdiff_t>(first + count);
        CHECK(block.time == std::vector<double>(whole.time.begin() + begin, whole.time.begin() + end));
        const auto& values = whole.channels.front().values;
        CHECK(block.channels.front().values == std::vector<double>(values.begin() + begin, values.begin() + end));
        CHECK(block.metadata == whole.metadata);
        next = first + count;
    }
    CHECK(next == samples);
}

TEST_CASE("What is wrong where blocks meet is found") {
    std::mt19937 random(1);
    const std::string head = makeText(3, random);
    const auto write = [&](const std::string& rest) { return test::TemporaryFile(head + rest); };
    const auto findAll = [](const std::string& file) {
        std::string text;
        for (const Recording& block : readBlocks(file, 4))
            for (const auto& warning : block.warnings) text += warning + "\n";
        return text;
    };
    const std::string tail = "0.006,1\n0.007,2\n0.008,1\n0.009,0\n";
    CHECK(findAll(write("0.003,1\n0.004,2\n0.005,3\n" + tail).path()).empty());
    CHECK_THAT(findAll(write("0.003,1\n0.0042,2\n" + tail).path()), Contains("gap"));
    CHECK_THAT(findAll(write("0.003,1\n0.004,2\n0.005,\n" + tail).path()), Contains("empty field"));
    // Row 7 ends a block, row 8 begins the next one.
    const test::TemporaryFile back(head + "0.003,1\n0.0015,2\n0.005,3\n" + tail);
    CHECK_THAT(findAll(back.path()), Contains("time goes back"));
}

TEST_CASE("Numbered samples and a rest position go through all blocks") {
    std::mt19937 random(2);
    const test::TemporaryFile file(makeText(5000, random));
    const ColumnMap map = parseColumnMap(
        "[columns]\n\"mobile.1.z\" = \"mobile.1.z\"\n[table]\ntime = \"none\"\nsample_interval = 0.5\nrest = 20.0\n",
        "map.toml");
    const Recording whole = readRecording(file.path(), &map);
    const auto blocks = readBlocks(file.path(), 700, &map);
    REQUIRE(blocks.size() > 3);
    CHECK(blocks.back().time.back() == whole.time.back());
    CHECK(blocks.back().channels.front().values.back() == whole.channels.front().values.back());
    CHECK(blocks.front().warnings == whole.warnings);
    CHECK(blocks.back().warnings.empty());
}

TEST_CASE("Bad rows of long recordings are named as in short ones") {
    std::mt19937 random(3);
    const std::string good = makeText(200000, random);
    const auto fails = [](const std::string& text, const std::string& message) {
        const test::TemporaryFile file(text);
        CHECK_THROWS_WITH(readBlocks(file.path(), 10000), Contains(message));
        CHECK_THROWS_WITH(readRecording(file.path()), Contains(message));
    };
    fails(good + "200.000,x\n", "200003");
    fails(good + "200.000,x\n", "'x' is not a number");
    fails(good + "200.000,1,2\n", "the row has 3 fields, the header has 2");
    fails(good + "\n200.000,1\n", "blank row inside the data");
    const test::TemporaryFile late(
        "time [s],mobile.1.z [mm],mobile.1.y [mm]\n0,1,\n1,2,\n2,3,\n3,4,1\n4,5,1\n5,6,1\n"
        "6,7,1\n7,8,1\n8,9,1\n");
    CHECK_THROWS_WITH(readBlocks(late.path(), 3), Contains("has values from this row on and none before"));
}

TEST_CASE("All formats but MATLAB before 7.3 are read in blocks") {
    CHECK(isStreamable(WEMS_SOURCE_DIR "/tests/recording/data/table.sto"));
    CHECK(isStreamable(WEMS_SOURCE_DIR "/tests/recording/data/pyuff_binary.uff"));
    CHECK(isStreamable(WEMS_SOURCE_DIR "/tests/recording/data/hdf5storage_matrix.mat"));
    CHECK_FALSE(isStreamable(WEMS_SOURCE_DIR "/tests/recording/data/scipy_vectors.mat"));
    CHECK_FALSE(isStreamable(WEMS_SOURCE_DIR "/tests/recording"));
    CHECK_FALSE(isStreamable("there-is-none.csv"));
    CHECK(isStreamable(WEMS_SOURCE_DIR "/tests/recording/data/daq_preamble.csv"));
}
