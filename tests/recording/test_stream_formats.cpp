// Long recordings of the formats other than CSV in blocks: together they are what readRecording() reads at once.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <random>

#include "models/common/error.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/recording/recording_stream.hpp"
#include "tests/recording/hdf5_sample.hpp"
#include "tests/recording/temporary_file.hpp"
#include "tests/seed.hpp"

using namespace wems;
using Catch::Contains;

namespace {

template <typename... Values>
std::string print(const char* format, Values... values) {
    std::array<char, 200> text{};
    std::snprintf(text.data(), text.size(), format, values...);
    return text.data();
}

double draw(std::mt19937& random) {
    return 1e-6 * static_cast<double>(random() % 2000000) - 1;
}

std::string makeTrc(std::size_t rows, std::mt19937& random) {
    std::string text =
        "PathFileType\t4\t(X/Y/Z)\trun.trc\nDataRate\tNumMarkers\tUnits\n1000\t2\tmm\n"
        "Frame#\tTime\tmobile.1\t\t\tmobile.2\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n";
    for (std::size_t k = 0; k < rows; ++k) {
        text += print("%zu\t%.3f", k + 1, 1e-3 * static_cast<double>(k));
        for (int i = 0; i < 6; ++i) text += print("\t%.6f", 300 + draw(random));
        text += "\n";
    }
    return text;
}

std::string makeStorage(std::size_t rows, std::mt19937& random) {
    std::string text = "run\nversion=1\nendheader\ntime\tmobile.1.z\tsomething\tload.fz\n";
    for (std::size_t k = 0; k < rows; ++k)
        text +=
            print("%.3f\t%.6f\t%.6f\t%.6f\n", 1e-3 * static_cast<double>(k), draw(random), draw(random), draw(random));
    return text;
}

/// X_Columns No, One or Multi.
std::string makeLvm(std::size_t rows, const std::string& times, std::mt19937& random) {
    const std::string gap = times == "Multi" ? "\t\t" : "\t";
    std::string text = "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t,\nX_Columns\t" + times +
                       "\n***End_of_Header***\t\n\t\nChannels\t2\nSamples\t" +
                       std::to_string(random() % 2 == 0 ? rows : rows / 2) + "\nY_Unit_Label\tmm" + gap + "N\nX0\t0,5" +
                       gap + "0,5\nDelta_X\t9,765625E-4" + gap +
                       "9,765625E-4\n***End_of_Header***\nX_Value\tmobile.1.z\t" +
                       (times == "Multi" ? "X_Value\t" : "") + "load.fz\tComment\n";
    for (std::size_t k = 0; k < rows; ++k) {
        const std::string stamp = times == "No" ? "" : print("%.6f", 0.5 + static_cast<double>(k) / 1024);
        std::string row = stamp + print("\t%.6f\t", draw(random)) + (times == "Multi" ? stamp + "\t" : "") +
                          print("%.6f", draw(random));
        std::replace(row.begin(), row.end(), '.', ',');
        text += row + (k % 100 == 0 ? "\tlooked at\n" : "\n");
    }
    return text;
}

struct UffKind {
    bool binary, even, double_precision;
};

/// Node 1 in +X and +Z, between them a spectrum, which is not read.
std::string makeUff(std::size_t points, const UffKind& kind, std::mt19937& random) {
    std::string text;
    for (const int direction : {1, 0, 3}) {
        const bool spectrum = direction == 0;
        std::string numbers;
        std::size_t on_line = 0;
        const auto add = [&](double value, bool wide) {
            if (kind.binary) {
                const auto narrow = static_cast<float>(value);
                std::array<char, 8> bytes{};
                std::memcpy(bytes.data(), wide ? static_cast<const void*>(&value) : &narrow, wide ? 8 : 4);
                numbers.append(bytes.data(), wide ? 8 : 4);
            } else {
                numbers += wide ? print("%20.11e", value) : print("%13.5e", value);
            }
        };
        const std::size_t per_line = (kind.double_precision ? 4U : 6U) / (kind.even ? 1U : 2U);
        for (std::size_t k = 0; k < points; ++k) {
            if (!kind.even) add(1e-3 * (static_cast<double>(k) + 0.3 * static_cast<double>(k % 2)), false);
            add(draw(random), kind.double_precision);
            if (!kind.binary && (++on_line % per_line == 0 || k + 1 == points)) numbers += "\n";
        }
        text += "    -1\n    58" +
                (kind.binary ? print("b%6d%6d%12d%12zu%6d%6d%12d%12d", 1, 2, 11, numbers.size(), 0, 0, 0, 0) : "") +
                "\nrun\nNONE\nNONE\nNONE\nNONE\n" +
                print("%5d%10d%5d%10d %-10s%10d%4d %-10s%10d%4d\n", spectrum ? 9 : 1, 0, 0, 0, "NONE", 1, direction,
                      "NONE", 0, 0) +
                print("%10d%10zu%10d%13.5e%13.5e%13.5e\n", kind.double_precision ? 4 : 2, points, kind.even ? 1 : 0,
                      0.0, 1e-3, 0.0);
        for (const int axis : {spectrum ? 18 : 17, 8, 0, 0})
            text += print("%10d%5d%5d%5d %-20s %-20s\n", axis, 0, 0, 0, "NONE",
                          axis == 17 ? "s" : (axis == 8 ? "mm" : "NONE"));
        text += numbers + "    -1\n";
    }
    return text;
}

std::string uffColumns() {
    return "[columns]\n\"1:+X\" = \"mobile.1.x\"\n\"1:+Z\" = \"mobile.1.z\"\n";
}

void checkBlocks(const std::string& file, const ColumnMap* map, std::size_t rows, bool even = true) {
    REQUIRE(isStreamable(file));
    const Recording whole = readRecording(file, map);
    RecordingStream stream(file, map, rows);
    CHECK(stream.expectedSamples() == Approx(whole.sampleCount()).epsilon(0.05));
    std::size_t next = 0;
    std::vector<std::string> warnings;
    for (Recording block; stream.next(block);) {
        const std::size_t first = next > 0 ? next - 1 : 0, count = block.sampleCount();
        REQUIRE(first + count <= whole.sampleCount());
        CHECK(block.first_row == whole.first_row + static_cast<long>(first));
        CHECK(block.format == whole.format);
        CHECK(block.unused_columns == whole.unused_columns);
        const auto part = [&](const std::vector<double>& values) {
            const auto begin = values.begin() + static_cast<std::ptrdiff_t>(first);
            return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(count));
        };
        CHECK(block.time == part(whole.time));
        REQUIRE(block.channels.size() == whole.channels.size());
        for (std::size_t c = 0; c < block.channels.size(); ++c) {
            CHECK(block.channels[c].name == whole.channels[c].name);
            CHECK(block.channels[c].values == part(whole.channels[c].values));
        }
        warnings.insert(warnings.end(), block.warnings.begin(), block.warnings.end());
        next = first + count;
    }
    CHECK(next == whole.sampleCount());
    if (even) CHECK(warnings == whole.warnings);  // uneven stamps are told of each block
}

}  // namespace

TEST_CASE("Blocks of OpenSim's tables join to the whole recording") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    const std::size_t samples = 10000 + random() % 10000, rows = 500 + random() % 12000;
    CAPTURE(samples, rows);
    checkBlocks(test::TemporaryFile(makeTrc(samples, random)).path(), nullptr, rows);
    checkBlocks(test::TemporaryFile(makeStorage(samples, random) + (random() % 2 == 0 ? "" : "\n\n")).path(), nullptr,
                rows);
}

TEST_CASE("Blocks of LabVIEW's text files join to the whole recording") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    const std::size_t samples = 10000 + random() % 10000, rows = 500 + random() % 12000;
    const auto times = GENERATE(as<std::string>(), "No", "One", "Multi");
    CAPTURE(samples, rows, times);
    checkBlocks(test::TemporaryFile(makeLvm(samples, times, random) + (random() % 2 == 0 ? "" : "\n\n")).path(),
                nullptr, rows);
}

TEST_CASE("Blocks of universal files join to the whole recording") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    const std::size_t samples = 10000 + random() % 10000, rows = 500 + random() % 12000;
    const auto kind = GENERATE(values<UffKind>({{false, true, true},
                                                {false, true, false},
                                                {false, false, true},
                                                {true, true, true},
                                                {true, false, false},
                                                {true, false, true}}));
    CAPTURE(samples, rows, kind.binary, kind.even, kind.double_precision);
    const ColumnMap map = parseColumnMap(uffColumns(), "map.toml");
    const test::TemporaryFile file(makeUff(samples, kind, random));
    checkBlocks(file.path(), &map, rows, kind.even);
    // The last function alone: the time is still that of the first.
    const ColumnMap last = parseColumnMap("[columns]\n\"1:+Z\" = \"mobile.1.z\"\n", "map.toml");
    checkBlocks(file.path(), &last, rows, kind.even);
}

TEST_CASE("Blocks of HDF5 files join to the whole recording") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    const std::size_t samples = 10000 + random() % 10000, rows = 500 + random() % 12000;
    const bool compressed = GENERATE(false, true), single = GENERATE(false, true);
    CAPTURE(samples, rows, compressed, single);
    const auto chunkOf = [&](const std::vector<hsize_t>& dims) {
        std::vector<hsize_t> chunk;
        for (const hsize_t dim : dims) chunk.push_back(1 + random() % std::min<hsize_t>(dim, 3000));
        return compressed ? chunk : std::vector<hsize_t>{};
    };
    std::vector<double> time(samples);
    for (std::size_t k = 0; k < samples; ++k) time[k] = static_cast<double>(k) / 1024;
    const auto drawn = [&](std::size_t count) {
        std::vector<double> values(count);
        for (double& value : values) value = draw(random);
        return values;
    };
    const test::TemporaryFile file;
    bool is_matrix = false;
    SECTION("vectors of any shape") {
        const std::vector<std::vector<hsize_t>> shapes{{samples}, {1, samples}, {samples, 1}};
        const test::Hdf5Sample sample(file.path());
        int shape = 0;
        for (const char* name : {"mobile_1_z", "load_fz", "base_az"}) {
            const auto& dims = shapes[shape++];
            sample.add(name, dims, chunkOf(dims), single, drawn(samples));
        }
        const auto& dims = shapes[random() % 3];
        sample.add("time", dims, chunkOf(dims), single, time);
    }
    SECTION("a matrix") {
        const bool row_by_row = GENERATE(true, false);  // a row of the file holds a sample of each channel
        CAPTURE(row_by_row);
        constexpr std::size_t kChannels = 7;
        std::vector<double> values = drawn(kChannels * samples);
        for (std::size_t k = 0; k < samples; ++k) values[row_by_row ? k * kChannels : k] = time[k];
        const std::vector<hsize_t> dims =
            row_by_row ? std::vector<hsize_t>{samples, kChannels} : std::vector<hsize_t>{kChannels, samples};
        const test::Hdf5Sample sample(file.path());
        sample.add("data", dims, chunkOf(dims), single, values);
        is_matrix = true;
    }
    const ColumnMap map = parseColumnMap(
        "[columns]\n\"data.1\" = { channel = \"time\", unit = \"s\" }\n"
        "\"data.6\" = { channel = \"load.fz\", unit = \"N\" }\n"
        "\"data.3\" = { channel = \"mobile.1.z\", unit = \"mm\" }\n",
        "map.toml");
    checkBlocks(file.path(), is_matrix ? &map : nullptr, rows);
}

TEST_CASE("A long HDF5 file that is cut off is refused") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    constexpr std::size_t kSamples = 6000;  // more than are read with the header
    const bool compressed = GENERATE(false, true);
    const test::TemporaryFile file;
    {
        const test::Hdf5Sample sample(file.path());
        std::vector<double> time(kSamples), values(2 * kSamples);
        for (std::size_t k = 0; k < kSamples; ++k) time[k] = static_cast<double>(k) / 1024;
        for (double& value : values) value = std::round(10 * draw(random));
        const auto pieces = [&](std::vector<hsize_t> chunk) { return compressed ? chunk : std::vector<hsize_t>{}; };
        sample.add("time", {kSamples}, pieces({1000}), true, time);
        sample.add("load_fz", {kSamples, 1}, pieces({500, 1}), false, values);
    }
    const std::string good = file.read();
    for (int i = 0; i < 50; ++i) {
        const test::TemporaryFile damaged(good.substr(0, 600 + random() % (good.size() - 600)));
        CAPTURE(i);
        CHECK_THROWS_AS(RecordingStream(damaged.path(), nullptr, 1000), InputError);
    }
}

TEST_CASE("What is wrong far inside a long recording is named as in a short one") {
    std::mt19937 random(5);
    const auto fails = [](const std::string& text, const ColumnMap* map, const std::string& message) {
        const test::TemporaryFile file(text);
        CHECK_THROWS_WITH(readRecording(file.path(), map), Contains(message));
        RecordingStream stream(file.path(), map, 1000);
        Recording block;
        CHECK_THROWS_WITH(
            [&] {
                while (stream.next(block)) {
                }
            }(),
            Contains(message));
    };
    const std::string storage = makeStorage(9000, random);
    fails(storage + "9.000\t1\tx\t1\n", nullptr, ":9005: 'x', number 3 of the row, is not a number");
    fails(storage + "\n9.000\t1\t1\t1\n", nullptr, ":9005: blank row inside the data");
    const std::string labview = makeLvm(9000, "One", random);
    fails(labview + "9,289062\t1\tx\n", nullptr, ":9014: 'x', field 3 of the row, is not a number");
    const ColumnMap map = parseColumnMap(uffColumns(), "map.toml");
    const std::string uff = makeUff(9000, {false, true, true}, random);
    fails(uff.substr(0, uff.size() - 5000), &map, "the file ends within a dataset 58");
    std::string late = makeUff(9000, {false, false, true}, random);
    late.replace(late.rfind("  8.99800e+00"), 13, "  8.99810e+00");
    const test::TemporaryFile file(late);
    RecordingStream stream(file.path(), &map, 1000);
    Recording block;
    CHECK_THROWS_WITH(
        [&] {
            while (stream.next(block)) {
            }
        }(),
        Contains("its times are not those of 1:+X"));
}
