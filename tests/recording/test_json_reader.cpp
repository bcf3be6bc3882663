// JSON tables: columns by name, rows by number, and what is no table.
#include <catch2/catch.hpp>
#include <cmath>

#include "models/common/error.hpp"
#include "models/recording/column_map.hpp"
#include "models/recording/json_reader.hpp"

using namespace wems;

TEST_CASE("JSON columns and rows are read as the same table") {
    const Recording columns = makeRecording(
        readJson(R"({"time [s]": [0, 0.1, 0.2], "relative.1.x [mm]": [1, 2, 3], "force.1.x [kN]": [4, 5, 6],
                                   "sample": "rubber 7"})",
                 "columns.json"),
        nullptr);
    const ColumnMap map = parseColumnMap(R"([columns]
"data.1" = { channel = "time", unit = "s" }
"data.2" = { channel = "relative.1.x", unit = "mm" }
"data.3" = { channel = "force.1.x", unit = "kN" })",
                                         "map.toml");
    const Recording rows =
        makeRecording(readJson(R"({"data": [[0, 1, 4], [0.1, 2, 5], [0.2, 3, 6]]})", "rows.json"), &map);
    const Recording bare = makeRecording(readJson("[[0, 1, 4], [0.1, 2, 5], [0.2, 3, 6]]", "bare.json"), &map);
    CHECK(columns.metadata.at("sample") == "rubber 7");
    for (const Recording* read : {&columns, &rows, &bare}) {
        CAPTURE(read->file);
        CHECK(read->time == std::vector<double>{0, 0.1, 0.2});
        REQUIRE(read->find("relative.1.x") != nullptr);
        REQUIRE(read->find("force.1.x") != nullptr);
        CHECK(read->find("relative.1.x")->values[2] == Approx(3e-3));
        CHECK(read->find("force.1.x")->values[2] == Approx(6e3));
    }
}

TEST_CASE("names beside JSON rows name their columns") {
    const Recording named = makeRecording(
        readJson(
            R"({"names": ["time", "relative.1.x"], "units": ["s", "m"], "data": [[0, 1], [1, 2], [2, null], [3, 4]]})",
            "named.json"),
        nullptr);
    REQUIRE(named.find("relative.1.x") != nullptr);
    CHECK(named.find("relative.1.x")->values.front() == 1);
    CHECK_FALSE(named.warnings.empty());  // a value is missing
}

TEST_CASE("JSON that is no table is refused in one line") {
    CHECK(isJson("  {\"a\": 1}"));
    CHECK(isJson("\n[[-1, 2]]"));
    CHECK_FALSE(isJson("time [s],q\n"));
    CHECK_FALSE(isJson("[body]\nmass = 1\n"));
    CHECK_FALSE(isJson("[[connection]]\n"));
    const auto refuses = [](const std::string& text) {
        try {
            makeRecording(readJson(text, "bad.json"), nullptr);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("read");
    };
    CHECK_THAT(refuses("{\"a\": [1, 2"), Catch::Contains("not JSON"));
    CHECK_THAT(refuses("{\n\n oops }"), Catch::Contains(":3"));
    CHECK_THAT(refuses("{\"data\": [[1, 2], [3]]}"), Catch::Contains("row 2"));
    CHECK_THAT(refuses("{\"data\": [[1, 2], [3, \"x\"]]}"), Catch::Contains("row 2"));
    CHECK_THAT(refuses("{}"), Catch::Contains("bad.json"));
    CHECK_THAT(refuses(std::string(50000, '[')), Catch::Contains("bad.json"));
}
