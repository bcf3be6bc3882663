// Damaged and misnamed files of the foreign formats: one line that says what is wrong, and never a crash.
#include <zlib.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

#include "models/common/error.hpp"
#include "models/recording/lvm_reader.hpp"
#include "models/recording/mat_file.hpp"
#include "models/recording/opensim_reader.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/recording/uff_reader.hpp"
#include "tests/recording/temporary_file.hpp"

using namespace wems;
using Catch::Contains;

namespace {

const std::string folder = std::string(WEMS_SOURCE_DIR) + "/tests/recording/data/";

std::string load(const std::string& name) {
    std::ifstream stream(folder + name, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

struct Case {
    std::string text, problem;
};

}  // namespace

TEST_CASE("Damaged universal files are refused") {
    const std::string good = load("pyuff_ascii.uff"), binary = load("pyuff_binary.uff");
    const auto c = GENERATE_COPY(values<Case>({
        {good.substr(0, 1369), "the file ends within a dataset 58"},
        {good.substr(0, 900), "the file ends within"},
        {binary.substr(0, 1370), "the file ends within the 256 bytes"},
        {replaced(good, "8.46963710093e-01", "8.46963710093x-01"), "'8.46963710093x-01' is not a number"},
        {replaced(good, "         4        32         1", "         3        32         1"), "3 is not a data type"},
        {replaced(good, "         4        32         1", "         4 999999999         1"), "the file ends within"},
        {replaced(good, "1.00000e-03", "0.00000e+00"), "the time step is not above zero"},
        {replaced(binary, "    58b     1     2", "    58b     1     3"), "DEC or IBM"},
        {"    -1\n   151\nsomething\n    -1\n", "there is no dataset 58"},
    }));
    INFO(c.problem);
    CHECK_THROWS_WITH(readUniversalFile(c.text, "run.uff"), Contains("run.uff") && Contains(c.problem));
}

TEST_CASE("Damaged files of OpenSim are refused") {
    const std::string trc = load("markers.trc"), sto = load("table.sto");
    const auto c = GENERATE_COPY(values<Case>({
        {replaced(trc, "(X/Y/Z)", "(Z/Y/X)"), "the order of the axes is '(Z/Y/X)'"},
        {replaced(trc, "\tUnits", "\tUnit"), "the header states no unit"},
        {replaced(trc, "Frame#", "Frame"), "does not begin with Frame#"},
        {replaced(trc, "0.002000", "0.00x"), ":9: '0.00x', number 2 of the row, is not a number"},
        {replaced(trc, "0.002000", "0.002000\t1\t2\t3"), "the row has more than the 8 numbers"},
    }));
    INFO(c.problem);
    CHECK_THROWS_WITH(readTrc(c.text, "run.trc"), Contains("run.trc") && Contains(c.problem));
    CHECK_THROWS_WITH(readStorage(replaced(sto, "DataType=double", "DataType=Rotation"), "run.sto"),
                      Contains("'Rotation' is not read") && Contains("Vec3"));
    CHECK_THROWS_WITH(readStorage(replaced(sto, "endheader", "end header"), "run.sto"),
                      Contains("no line `endheader`"));
}

TEST_CASE("Damaged files of LabVIEW are refused") {
    const std::string none = load("labview_no_times.lvm"), one = load("labview_one_time.lvm"),
                      each = load("labview_each_time.lvm");
    const std::string segment = each.substr(each.find("Channels"));
    const auto c = GENERATE_COPY(values<Case>({
        {none.substr(0, 300), "the file ends within a header"},
        {replaced(one, "Separator,Comma", "Separator,Tab"), "Separator: is 'Tab'"},
        {replaced(one, "Decimal_Separator,.", "Decimal_Separator,;"), "Decimal_Separator: is ';'"},
        {replaced(one, "X_Columns,One", "X_Columns,Two"), "X_Columns: is 'Two'"},
        {replaced(one, "X_Value,", "X,"), "does not begin with X_Value"},
        {replaced(one, "Channels,3", "Channels,999999999"), "channels that the row of their names does not have"},
        {replaced(one, "Channels,3", "Channels,-1"), "'-1' is no count"},
        {replaced(one, "Time,Time", "Time,Frequency"), "X_Dimension: of 'A1' is 'Frequency'"},
        {replaced(none, "\t0,001000", "\t0,002000"), "Delta_X: channel 2 has another one"},
        {replaced(none, "0,001000\t0,001000\t0,001000", "0\t0\t0"), "the time step is not above zero"},
        {replaced(none, "0,001000", "0,001x"), "Delta_X: '0,001x', of channel 1, is not a number"},
        {replaced(one, "0.002000", "0.00x"), ":24: '0.00x', field 1 of the row, is not a number"},
        {replaced(each, "\t0.002000", "\t0.002500"), ":24: channel 2 has another time"},
        {replaced(one, "0.002000", "\n0.002000"), ":24: blank row inside the data"},
        {each + "\r\n" + segment, ":55: a further segment begins"},
    }));
    INFO(c.problem);
    CHECK_THROWS_WITH(readLvm(c.text, "run.lvm"), Contains("run.lvm") && Contains(c.problem));
}

TEST_CASE("MATLAB files whose sizes cannot be true are refused before memory is taken for them") {
    CHECK_THROWS_WITH(readRecording(folder + "damaged_name_length.mat"), Contains("is damaged or cut off"));
    CHECK_THROWS_WITH(readRecording(folder + "damaged_field_names.mat"), Contains("is damaged or cut off"));
    CHECK_THROWS_WITH(readRecording(folder + "damaged_flags.mat"), Contains("is damaged or cut off"));
    CHECK_THROWS_AS(readRecording(folder + "damaged_empty_text.mat"), InputError);  // 134 million rows of no length
    const auto refuses = [](const std::string& bytes) {
        const test::TemporaryFile file(bytes);
        const std::string named = file.path() + ".mat";
        std::filesystem::copy_file(file.path(), named);
        CHECK_THROWS_WITH(readRecording(named), Contains("is damaged or cut off"));
        std::filesystem::remove(named);
    };
    const std::string good = load("scipy_channels.mat");
    refuses(good.substr(0, good.size() - 20));
    std::string many = good;
    many[0xA3] = '\x10';  // the number of rows of the structure array
    refuses(many);
    const std::string old("\0\0\0\0\0\0\1\0\1\0\0\0\0\0\0\0\2\0\0\0a\0", 22);  // version 4: 65536 rows
    refuses(old + std::string(100, 'x'));
}

TEST_CASE("Compressed MATLAB variables that claim more than they hold are refused, whole ones are read") {
    const std::string file_header = load("scipy_channels.mat").substr(0, 128);
    const auto word = [](std::uint32_t value) { return std::string(reinterpret_cast<const char*>(&value), 4); };
    const auto element = [&](std::uint32_t type, const std::string& data) {
        return word(type) + word(static_cast<std::uint32_t>(data.size())) + data +
               std::string((8 - data.size() % 8) % 8, '\0');
    };
    // A column of doubles `time`; the header may claim other sizes than there are values.
    const auto variable = [&](std::uint32_t rows, std::uint32_t more, std::size_t values) {
        const std::string array = element(6, word(6) + word(0)) + element(5, word(rows) + word(1)) +
                                  element(1, "time") + element(9, std::string(8 * values, '\0'));
        return word(14) + word(static_cast<std::uint32_t>(array.size()) + more) + array;
    };
    const auto compressed = [&](const std::string& plain, std::size_t cut) {
        std::vector<Bytef> stream(compressBound(plain.size()));
        uLongf size = stream.size();
        REQUIRE(compress(stream.data(), &size, reinterpret_cast<const Bytef*>(plain.data()), plain.size()) == Z_OK);
        size -= cut;
        return file_header + word(15) + word(static_cast<std::uint32_t>(size)) +
               std::string(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(size));
    };
    CHECK_NOTHROW(checkMatExtent(compressed(variable(100, 0, 100), 0), "run.mat"));
    // Compressed 700-fold, which is rare but true.
    CHECK_NOTHROW(checkMatExtent(compressed(variable(100000, 0, 100000), 0), "run.mat"));
    const auto refuses = [](const std::string& content) {
        CHECK_THROWS_WITH(checkMatExtent(content, "run.mat"),
                          Contains("run.mat") && Contains("the variable compressed at byte 136"));
    };
    refuses(compressed(variable(4000000000, 0, 100), 0));   // more rows than bytes
    refuses(compressed(variable(100, 1U << 30U, 100), 0));  // an array larger than its stream
    refuses(compressed(variable(100000, 0, 100000), 40));   // a stream that is cut off
    std::string flipped = compressed(variable(100, 0, 100), 0);
    flipped[137] = '\x7f';  // no zlib stream
    refuses(flipped);
    std::string checksum = compressed(variable(100, 0, 100), 0);
    checksum.back() = static_cast<char>(checksum.back() ^ 1);
    CHECK_THROWS_WITH(checkMatExtent(checksum, "run.mat"), Contains("the variable compressed at byte 136 is damaged"));
}

TEST_CASE("MATLAB's store of objects, a variable without a name, is no column") {
    const std::string file_header = load("scipy_channels.mat").substr(0, 128);
    const auto word = [](std::uint32_t value) { return std::string(reinterpret_cast<const char*>(&value), 4); };
    const auto element = [&](std::uint32_t type, const std::string& data) {
        return word(type) + word(static_cast<std::uint32_t>(data.size())) + data +
               std::string((8 - data.size() % 8) % 8, '\0');
    };
    const auto variable = [&](const std::string& name) {
        return element(14, element(6, word(6) + word(0)) + element(5, word(16) + word(1)) + element(1, name) +
                               element(9, std::string(std::size_t{8} * 16, '\0')));
    };
    const auto write = [](const std::string& content) {
        return test::TemporaryFile(content);  // begins with "MATLAB 5.0", whatever its name
    };
    CHECK_THROWS_WITH(readRecording(write(file_header + variable("")).path()),
                      Contains("holds no numeric vector or matrix") && Contains("objects must be saved"));
    CHECK_THROWS_WITH(readRecording(write(file_header + variable("a") + variable("")).path()),
                      Contains("there is no time column; there are a (accepted"));
}

TEST_CASE("A name that promises another content") {
    const test::TemporaryFile file("time [s],mobile.1.x [m]\n0,1\n1,2\n");
    const auto extension = GENERATE(as<std::string>(), ".trc", ".sto", ".mot", ".lvm", ".uff", ".unv", ".mat", ".h5");
    const std::string misnamed = file.path() + extension;
    std::filesystem::copy_file(file.path(), misnamed);
    CHECK_THROWS_WITH(readRecording(misnamed), Contains(misnamed));
    std::filesystem::remove(misnamed);
}

TEST_CASE("A model given as a recording") {
    const test::TemporaryFile file("[body]\nmass = 5.0\n");
    const std::string model = file.path() + ".toml";
    std::filesystem::copy_file(file.path(), model);
    CHECK_THROWS_WITH(readRecording(model), Contains(model) && Contains("a TOML file where a recording is expected"));
    std::filesystem::remove(model);
}

TEST_CASE("Every cut and every flipped byte of a text format is read or refused") {
    const auto name = GENERATE(as<std::string>(), "pyuff_ascii.uff", "pyuff_binary.uff", "markers.trc", "table.sto",
                               "labview_no_times.lvm", "labview_each_time.lvm", "daq_preamble.csv");
    const std::string good = load(name);
    const unsigned seed = 20240607;
    INFO(name << ", seed " << seed);
    std::mt19937 random(seed);
    int refused = 0;
    for (int i = 0; i < 300; ++i) {
        std::string bad = good;
        const auto at = std::uniform_int_distribution<std::size_t>(0, good.size() - 1)(random);
        if (i % 3 == 0) {
            bad.resize(at);
        } else {
            bad[at] = static_cast<char>(std::uniform_int_distribution<int>(1, 255)(random));
        }
        const test::TemporaryFile file(bad.empty() ? " " : bad);
        try {
            const Recording recording = readRecording(file.path());
            for (const auto& channel : recording.channels)
                for (const double value : channel.values) REQUIRE(std::isfinite(value));
        } catch (const InputError& error) {
            ++refused;
            CHECK(std::string(error.what()).find('\n') == std::string::npos);
        }
    }
    CHECK(refused > 50);
}
