#include <catch2/catch.hpp>

#include "models/common/error.hpp"
#include "models/recording/column_map.hpp"
#include "models/recording/csv_reader.hpp"

using namespace wems;
using Catch::Contains;
using Catch::StartsWith;

namespace {

Recording readWith(const std::string& map_text, const std::string& csv) {
    const ColumnMap map = parseColumnMap(map_text, "map.toml");
    return parseRecording(csv, "run.csv", &map);
}

}  // namespace

TEST_CASE("A map gives columns their channels, units, scales and offsets") {
    const auto recording = readWith(
        "[columns]\n"
        "\"t [s]\" = \"time\"\n"
        "\"Displacement (in)\" = \"relative.1.x\"\n"
        "\"Velocity\" = \"relative.1.vx\"\n"
        "plain = { channel = \"force.1.x\", unit = \"kN\", scale = -2.0, offset = 0.5 }\n",
        "t [s],Displacement (in),Velocity (in/s),plain,load.fz [N],rest\n0,1,2,3,4,5\n1,2,3,4,5,6\n");
    REQUIRE(recording.channels.size() == 4);
    CHECK(recording.find("relative.1.x")->values[0] == Approx(0.0254));
    CHECK(recording.find("relative.1.vx")->values[1] == Approx(3 * 0.0254));
    CHECK(recording.find("force.1.x")->values[1] == Approx((-2.0 * 4 + 0.5) * 1000));
    CHECK(recording.find("load.fz")->values[0] == 4);
    CHECK(recording.unused_columns == std::vector<std::string>{"rest"});
}

TEST_CASE("The map's unit goes before the header's") {
    const auto recording = readWith(
        "[columns]\na = { channel = \"time\", unit = \"ms\" }\n\"b [mm]\" = { channel = \"load.fx\", unit = \"N\" }\n",
        "a [s],b [mm]\n0,1\n1,2\n");
    CHECK(recording.time[1] == 1e-3);
    CHECK(recording.channels[0].values[1] == 2);
}

TEST_CASE("Without a time column samples are numbered") {
    const std::string columns =
        "[columns]\nx = { channel = \"relative.1.z\", unit = \"mm\" }\n[table]\ntime = \"none\"\n";
    CHECK(readWith(columns, "x\n5\n6\n7\n").time == std::vector<double>{0, 1, 2});
    CHECK(readWith(columns + "sample_interval = 0.25\n", "x\n5\n6\n7\n").time == std::vector<double>{0, 0.25, 0.5});
}

TEST_CASE("The file's shape can be told") {
    const auto recording = readWith(
        "[columns]\nt = { channel = \"time\", unit = \"s\" }\nx = { channel = \"load.fx\", unit = \"N\" }\n"
        "[table]\nskip_rows = 2\nseparator = \";\"\ndecimal = \",\"\n",
        "Device, no. 5;\nwritten, on; a; Monday\nt;x\n0;1,5\n1;2\n");
    CHECK(recording.channels[0].values[0] == 1.5);
    CHECK(recording.first_row == 4);
}

TEST_CASE("Bad maps are refused with line and key") {
    struct Case {
        const char* text;
        long line;
        const char *key, *problem;
    };
    const auto c = GENERATE(values<Case>({
        {"[columns", 1, "", "not valid TOML"},
        {"", 0, "columns", "no column is mapped"},
        {"[columns]\n", 0, "columns", "no column is mapped"},
        {"[column]\n", 1, "column", "unknown key (accepted: columns, table)"},
        {"columns = 3\n", 1, "columns", "must be a table"},
        {"[columns]\na = 3\n", 2, "columns.\"a\"", "must be text in quotes"},
        {"[columns]\na = \"mobile.x\"\n", 2, "columns.\"a\"", "'mobile.x' is not a channel (accepted: time, mobile."},
        {"[columns]\na = \"time\"\nb = \"time\"\n", 3, "columns.\"b\"", "'time' is given by column 'a' already"},
        {"[columns]\na = { unit = \"mm\" }\n", 2, "columns.\"a\"", "channel is missing"},
        {"[columns]\na = { channel = \"time\", units = \"s\" }\n", 2, "columns.\"a\".units", "unknown key"},
        {"[columns]\na = { channel = \"time\", scale = 0 }\n", 2, "columns.\"a\".scale", "must not be 0"},
        {"[columns]\na = { channel = \"time\", scale = nan }\n", 2, "columns.\"a\".scale", "must be a finite number"},
        {"[columns]\na = { channel = \"time\", offset = \"1\" }\n", 2, "columns.\"a\".offset", "finite number"},
        {"[columns]\na = \"time\"\n[table]\ntime = \"auto\"\n", 4, "table.time", "accepted: \"none\""},
        {"[columns]\na = \"time\"\n[table]\nseparator = \"|\"\n", 4, "table.separator", "'|' is not understood"},
        {"[columns]\na = \"time\"\n[table]\ndecimal = \"..\"\n", 4, "table.decimal", "accepted: \".\", \",\""},
        {"[columns]\na = \"time\"\n[table]\nskip_rows = -1\n", 4, "table.skip_rows", "whole number"},
        {"[columns]\na = \"time\"\n[table]\nskip_rows = 1.5\n", 4, "table.skip_rows", "whole number"},
        {"[columns]\na = \"time\"\n[table]\nsample_interval = 1\n", 4, "table.sample_interval", "only with time"},
        {"[columns]\na = \"time\"\n[table]\ntime = \"none\"\nsample_interval = 0\n", 5, "table.sample_interval",
         "must be above 0"},
        {"[columns]\na = \"time\"\n[table]\nrows = 1\n", 4, "table.rows", "unknown key"},
    }));
    INFO(c.text);
    try {
        parseColumnMap(c.text, "map.toml");
        FAIL("read without error");
    } catch (const InputError& error) {
        CHECK_THAT(error.what(), StartsWith("map.toml") && Contains(c.problem));
        CHECK(error.location().line == c.line);
        CHECK(error.location().key == c.key);
    }
}

TEST_CASE("A map and a file that do not fit") {
    const std::string csv = "t [s],x\n0,1\n1,2\n";
    CHECK_THROWS_WITH(readWith("[columns]\n\"t [s]\" = \"time\"\ny = \"load.fx\"\n", csv),
                      "map.toml:3: y: there is no such column in run.csv (accepted: t [s], x)");
    CHECK_THROWS_WITH(readWith("[columns]\n\"t [s]\" = \"time\"\nx = \"load.fx\"\n", csv),
                      StartsWith("run.csv:1: load.fx: column 'x' has no unit"));
    CHECK_THROWS_WITH(readWith("[columns]\n\"t [s]\" = \"time\"\nx = { channel = \"load.fx\", unit = \"mm\" }\n", csv),
                      StartsWith("run.csv:1: load.fx: 'mm' is not a unit of force"));
    CHECK_THROWS_WITH(readWith("[columns]\nt = \"time\"\nx = { channel = \"load.fx\", unit = \"N\" }\n",
                               "t [s],x,load.fx [N]\n0,1,2\n"),
                      StartsWith("run.csv:1: load.fx: there are two columns"));
    CHECK_THROWS_WITH(readColumnMap("/no/such/map.toml"), StartsWith("/no/such/map.toml: "));
}
