// Files that other programs wrote, all of the same run (data/make_samples.py): the formulas are the expectation.
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <iterator>

#include "models/common/error.hpp"
#include "models/common/text_file.hpp"
#include "models/recording/lvm_reader.hpp"
#include "models/recording/opensim_reader.hpp"
#include "models/recording/recording_reader.hpp"
#include "tests/recording/hdf5_sample.hpp"
#include "tests/recording/temporary_file.hpp"

using namespace wems;
using Catch::Contains;

namespace {

const std::string folder = std::string(WEMS_SOURCE_DIR) + "/tests/recording/data/";

double timeAt(int k) {
    return k / 1000.0;
}
double zAt(int k) {
    return 1.5e-3 * std::sin(0.3 * k);
}
double azAt(int k) {
    return -0.25 * 9.80665 * std::cos(0.2 * k);
}
double fzAt(int k) {
    return 200 * std::sin(0.1 * k);
}

void checkChannel(const Recording& recording, const std::string& name, double (*expected)(int), double tolerance) {
    const Channel* channel = recording.find(name);
    INFO(recording.file << ": " << name);
    REQUIRE(channel != nullptr);
    REQUIRE(channel->values.size() == 32);
    for (int k = 0; k < 32; ++k) CHECK(channel->values[k] == Approx(expected(k)).margin(tolerance).epsilon(0));
}

void checkTime(const Recording& recording) {
    REQUIRE(recording.time.size() == 32);
    for (int k = 0; k < 32; ++k) CHECK(recording.time[k] == Approx(timeAt(k)).margin(1e-9).epsilon(0));
}

ColumnMap mapOf(const std::string& columns, const std::string& table = {}) {
    return parseColumnMap("[columns]\n" + columns + "\n[table]\n" + table + "\n", "map.toml");
}

Recording read(const std::string& name, const std::string& columns = {}, const std::string& table = {}) {
    if (columns.empty()) return readRecording(folder + name);
    const ColumnMap map = mapOf(columns, table);
    return readRecording(folder + name, &map);
}

const std::string lab_channels = "\"LVDT top\" = \"mobile.1.z\"\nA1 = \"mobile.1.az\"\nForce = \"load.fz\"\n";
const std::string lab_names = "\"t\" = \"time\"\n" + lab_channels;

struct Sample {
    std::string file, format, columns;
    double tolerance;  ///< of what the file's digits hold, relative to the amplitude
};

}  // namespace

TEST_CASE("Several tabs between the settings of a .trc, as some motion capture programs write them") {
    std::ifstream stream(folder + "markers.trc", std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    const auto row = text.find("1000.00\t1000.00\t32");
    REQUIRE(row != std::string::npos);
    const auto end = text.find('\n', row);
    for (auto at = text.rfind('\t', end); at != std::string::npos && at > row; at = text.rfind('\t', at - 1))
        text.insert(at, 1, '\t');
    CHECK(readTrc(text, "run.trc").metadata.at("Units") == "mm");
    CHECK(readTrc(text, "run.trc").metadata.at("NumMarkers") == "2");
}

TEST_CASE("The same run out of every format") {
    const auto nodes = std::string(
        "\"12:+Z\" = \"mobile.1.z\"\nA1 = { channel = \"mobile.1.az\", scale = -1.0 }\n"
        "\"1:+Z\" = \"load.fz\"\n");
    const auto sample = GENERATE_COPY(values<Sample>({
        {"scipy_vectors.mat", "MATLAB 5", "", 1e-7},
        {"scipy_matrix.mat", "MATLAB 5", lab_names, 1e-15},
        {"scipy_channels.mat", "MATLAB 5",
         "\"Time\" = \"time\"\n\"LVDT top\" = \"mobile.1.z\"\nA1 = \"mobile.1.az\"\nForce = \"load.fz\"\n", 1e-15},
        {"hdf5storage_matrix.mat", "MATLAB 7.3", lab_names, 1e-15},
        {"hdf5storage_vectors.mat", "MATLAB 7.3", "", 1e-15},
        {"pyuff_ascii.uff", "UFF 58", nodes, 1e-11},
        {"pyuff_ascii_single.uff", "UFF 58", nodes, 1e-5},
        {"pyuff_binary.uff", "UFF 58b", nodes, 1e-15},
        {"pyuff_binary_single.uff", "UFF 58b", nodes, 1e-15},  // says single precision, holds double
        {"big_endian_single.uff", "UFF 58b", nodes, 1e-7},
        {"labview_no_times.lvm", "LabVIEW .lvm", lab_channels, 4e-6},
        {"labview_one_time.lvm", "LabVIEW .lvm", lab_channels, 4e-6},
        {"labview_each_time.lvm", "LabVIEW .lvm", lab_channels, 4e-6},
        {"table.sto", "OpenSim .sto", "ground_force_vy = \"load.fz\"\n", 1e-8},
        {"daq_preamble.csv", "CSV",
         "t = \"time\"\n'LVDT \"oben\"' = \"mobile.1.z\"\nA1 = \"mobile.1.az\"\n\"Kraft, axial\" = \"load.fz\"\n",
         4e-6},
        {"daq_unit_row.csv", "CSV", "A1 = \"mobile.1.az\"\n", 4e-6},
    }));
    const Recording recording = read(sample.file, sample.columns);
    CHECK(recording.format == sample.format);
    checkTime(recording);
    // In the universal files the accelerometer points to -Z; its column says so by the direction, the map by the sign.
    const double sign = sample.format.substr(0, 3) == "UFF" ? -1 : 1;
    const Channel* az = recording.find("mobile.1.az");
    REQUIRE(az != nullptr);
    for (int k = 0; k < 32; ++k)
        CHECK(az->values[k] == Approx(sign * azAt(k)).margin(sample.tolerance * 9.8).epsilon(0));
    checkChannel(recording, "mobile.1.z", zAt, sample.tolerance * 1.5e-3);
    checkChannel(recording, "load.fz", fzAt, sample.tolerance * 200);
}

TEST_CASE("MATLAB 7.3 keeps its objects as places in a store of its own, which are no numbers of the user's") {
    const test::TemporaryFile file;
    {
        const test::Hdf5Sample sample(file.path());
        sample.add("time", {6}, {}, false, {0, 1, 2, 3, 4, 5});
        sample.add("load_fz", {1, 6}, {}, false, {1, 2, 3, 2, 1, 0});
        sample.add("sweep", {1, 6}, {}, false, {3707764736, 2, 1, 1, 1, 1});
        sample.mark("sweep", "MATLAB_object_decode", 3);
    }
    const Recording recording = readRecording(file.path());
    CHECK(recording.unused_columns.empty());
    REQUIRE_FALSE(recording.warnings.empty());
    CHECK_THAT(recording.warnings[0], Contains("sweep is complex, sparse, an object or empty, and is not read"));
}

TEST_CASE("Names in the code page of a computer become UTF-8, what is UTF-8 stays") {
    const auto [letter, written] =
        GENERATE(table<std::string, std::string>({{"\xB0", "\u00B0"}, {"\u00B0", "\u00B0"}, {"\u20AC", "\u20AC"}}));
    const auto header =
        GENERATE(as<std::string>(), "# by: @\ntime [s],mobile.1.z [m],T @ [C]\n",
                 "by: @\nabout @\ntime [s],mobile.1.z [m],T @ [C]\n", "by @\nendheader\ntime\tmobile.1.z\tT @\n");
    std::string text = header;
    for (auto at = text.find('@'); at != std::string::npos; at = text.find('@', at)) text.replace(at, 1, letter);
    const char separator = text.find('\t') == std::string::npos ? ',' : '\t';
    for (int k = 0; k < 20; ++k)
        text += std::to_string(k) + separator + std::to_string(k % 3) + separator + std::to_string(k % 5) + "\n";
    const Recording recording = readRecording(test::TemporaryFile(text).path());
    CAPTURE(text);
    REQUIRE(recording.unused_columns.size() == 1);
    CHECK_THAT(recording.unused_columns[0], Contains("T " + written));
    if (separator == ',') CHECK(recording.metadata.at("by") == written);
    for (const auto& name : recording.unused_columns) CHECK(isUtf8(name));
    for (const auto& [key, value] : recording.metadata) CHECK((isUtf8(key) && isUtf8(value)));
}

TEST_CASE("UTF-8 is told from what is not, and cut between characters") {
    for (const char* good : {"", "plain", "\u00B0", "\u20AC", "\U0001F600"}) CHECK(isUtf8(good));
    for (const char* bad :
         {"\xB0", "\xC3", "\xC0\x80", "\xE0\x80\x80", "\xED\xA0\x80", "\xF4\x90\x80\x80", "a\xE2\x82"})
        CHECK_FALSE(isUtf8(bad));
    CHECK(cutUtf8("ab\u20AC", 3) == "ab …");
    CHECK(cutUtf8("ab\u20AC", 5) == "ab\u20AC");
    CHECK(decodeLatin1("\xE9\xFF") == "\u00E9\u00FF");
}

TEST_CASE("What is no channel is listed or kept as metadata") {
    const Recording vectors = read("scipy_vectors.mat");
    CHECK(vectors.metadata.at("fs") == "1000");
    CHECK(vectors.metadata.at("comment") == "sine");
    REQUIRE(vectors.warnings.size() == 2);
    CHECK_THAT(vectors.warnings[0], Contains("complex_one is complex"));
    CHECK_THAT(vectors.warnings[1], Contains("no unit of time, mobile.1.z, mobile.1.az, load.fz; SI is assumed"));

    const Recording daq = read("daq_unit_row.csv", "A1 = \"mobile.1.az\"\n");
    CHECK(daq.metadata.at("Operator") == "nobody");
    CHECK(daq.metadata.at("Scan rate") == "1000 Hz");
    CHECK(daq.first_row == 8);
    CHECK(daq.unused_columns == std::vector<std::string>{"Channel"});
    REQUIRE(daq.warnings.size() == 1);
    CHECK_THAT(daq.warnings[0], Contains("row 7, between header and numbers, is not read"));

    std::ifstream stream(folder + "labview_no_times.lvm", std::ios::binary);
    std::string packets{std::istreambuf_iterator<char>(stream), {}};
    CHECK(readLvm(packets, "run.lvm").warnings.empty());
    packets.replace(packets.find("\t32"), 3, "\t16");
    REQUIRE(readLvm(packets, "run.lvm").warnings.size() == 1);
    CHECK_THAT(readLvm(packets, "run.lvm").warnings[0], Contains("packets of 16 samples stand on end"));

    // 1/1024 s as LabVIEW writes it is 0.05 % off; the rate of 1000 Hz that stands there is taken at its word.
    for (auto at = packets.find("0,001000"); at != std::string::npos; at = packets.find("0,001000"))
        packets.replace(at, 8, "0,000977");
    CHECK_THAT(readLvm(packets, "run.lvm").warnings[0],
               Contains("Delta_X 0,000977 is rounded: the sampling rate is known to 0.051 % only"));

    const Recording labview = read("labview_each_time.lvm", lab_channels);
    CHECK(labview.metadata.at("Operator") == "nobody");
    CHECK(labview.first_row == 22);

    const Recording functions = read("pyuff_binary.uff", "\"12:+Z\" = \"mobile.1.z\"\n");
    REQUIRE(functions.warnings.size() == 1);
    CHECK_THAT(functions.warnings[0], Contains("(FRF) is not read: it is no time response"));
}

TEST_CASE("Markers are positions; their rest is the first row, or what the map says") {
    const Recording first = read("markers.trc", "\"TOP.z\" = \"mobile.1.z\"\n\"TOP_X\" = \"mobile.1.x\"\n");
    CHECK(first.format == "OpenSim .trc");
    checkTime(first);
    checkChannel(first, "mobile.1.z", zAt, 1e-9);
    CHECK(first.find("mobile.1.z")->unit == "mm");
    CHECK(first.find("mobile.1.x")->values[5] == 0);
    CHECK_THAT(first.warnings.front(), Contains("first row (up to 0.25 m from the origin)"));

    const Recording mean = read("markers.trc", "\"TOP.z\" = \"mobile.1.z\"\n", "rest = 0.0035");
    const double rest = (zAt(0) + zAt(1) + zAt(2) + zAt(3)) / 4;
    CHECK(mean.find("mobile.1.z")->values[9] == Approx(zAt(9) - rest).margin(1e-9).epsilon(0));

    const Recording none = read("markers.trc", "\"TOP.z\" = \"mobile.1.z\"\n", "rest = \"none\"");
    CHECK(none.find("mobile.1.z")->values[9] == Approx(0.25 + zAt(9)).margin(1e-9).epsilon(0));

    // Two rows in which the marker is hidden are bridged, and said.
    const Recording hidden = read("markers.trc", "\"R.ASIS.y\" = \"mobile.1.y\"\n\"TOP.z\" = \"mobile.1.z\"\n");
    CHECK(hidden.find("mobile.1.y")->values[8] == Approx(0).margin(1e-12));
    CHECK_THAT(hidden.warnings.back(), Contains("mobile.1.y: empty field, interpolated") && Contains("14, 15"));
}

TEST_CASE("Tables of vectors, and those of the older motion files") {
    const Recording vectors = read("vectors.sto", "\"force.z\" = \"load.fz\"\n");
    checkTime(vectors);
    checkChannel(vectors, "mobile.1.z", zAt, 1e-12);
    checkChannel(vectors, "load.fz", fzAt, 1e-9);
    const Recording motion = read("simm.mot");
    checkTime(motion);
    checkChannel(motion, "mobile.1.z", zAt, 1e-12);
    checkChannel(motion, "mobile.1.az", azAt, 1e-11);
}

TEST_CASE("Foreign units are stated or asked for, never guessed") {
    const ColumnMap map = mapOf("\"data.2\" = \"mobile.1.z\"\n\"data.1\" = \"time\"");
    // A map that names a column of a matrix by its number; the unit is the one in the list of units.
    checkTime(readRecording(folder + "scipy_matrix.mat", &map));
    const ColumnMap unknown = mapOf("load_fz = \"load.fz\"\nmobile_1_z = \"mobile.2.z\"");
    CHECK_THROWS_WITH(readRecording(folder + "scipy_vectors.mat", &unknown),
                      Contains("column 'mobile.1.z' has no unit") && Contains("unit = \"m\"` in the column map"));
    const ColumnMap nothing = mapOf("A2 = \"mobile.1.z\"");
    CHECK_THROWS_WITH(readRecording(folder + "scipy_matrix.mat", &nothing),
                      Contains("A2: there is no such column") && Contains("t, LVDT top, A1, Force"));
    CHECK_THROWS_WITH(readRecording(folder + "pyuff_ascii.uff"),
                      Contains("no column is a channel; there are time, 12:+Z, 7:-Z, 1:+Z"));
}
