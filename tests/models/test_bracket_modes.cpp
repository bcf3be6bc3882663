#include <catch2/catch.hpp>
#include <string>

#include "models/bracket.hpp"
#include "models/common/error.hpp"

using namespace wems;

namespace {

const std::string header = "frequency [Hz],damping_ratio,ux,uy,uz,rx,ry,rz,load.ux,load.uy,load.uz";
const std::string row = "34.5,0.01,1,2,3,4,5,6,7,8,-9e-1";

}  // namespace

TEST_CASE("modes file: every column lands in its place") {
    const std::string end_of_line = GENERATE("\n", "\r\n");
    const std::string mark = GENERATE("", "\xEF\xBB\xBF");
    const auto modes = parseBracketModes(mark + "# comment" + end_of_line + header + ",base.ux,base.uy,base.uz" +
                                             end_of_line + end_of_line + row + ", +10 ,11,12" + end_of_line +
                                             "# another" + end_of_line + row + ",0,0,0",
                                         "m.csv");
    REQUIRE(modes.size() == 2);
    CHECK(modes[0].frequency == 34.5);
    CHECK(modes[0].damping_ratio == 0.01);
    CHECK(modes[0].translation == Eigen::Vector3d(1, 2, 3));
    CHECK(modes[0].rotation == Eigen::Vector3d(4, 5, 6));
    CHECK(modes[0].load_translation == Eigen::Vector3d(7, 8, -0.9));
    CHECK(modes[0].base_participation == Eigen::Vector3d(10, 11, 12));
}

TEST_CASE("modes file: what is written reads back digit for digit") {
    const bool with_base = GENERATE(false, true);
    std::vector<BracketMode> modes(2);
    for (auto& mode : modes) {
        mode.frequency = 100.0 / 3;
        mode.damping_ratio = 0.1 / 7;
        mode.translation = Eigen::Vector3d(1, -2, 0) / 3;
        mode.rotation = Eigen::Vector3d(4e-17, 5, -6) / 7;
        mode.load_translation = Eigen::Vector3d(7, 8, 9e12) / 11;
    }
    if (with_base) modes[1].base_participation = {1, 0.1, -0.3};
    const auto again = parseBracketModes(formatBracketModes(modes), "m.csv");
    REQUIRE(again.size() == modes.size());
    for (std::size_t j = 0; j < modes.size(); ++j) {
        CHECK(again[j].frequency == modes[j].frequency);
        CHECK(again[j].damping_ratio == modes[j].damping_ratio);
        CHECK(again[j].translation == modes[j].translation);
        CHECK(again[j].rotation == modes[j].rotation);
        CHECK(again[j].load_translation == modes[j].load_translation);
        CHECK(again[j].base_participation == modes[j].base_participation);
    }
}

TEST_CASE("modes file: what cannot be used is named with file, line and column") {
    struct Case {
        std::string text;
        long line;
        std::string key, part;
    };
    const Case bad = GENERATE(values<Case>({
        {"", 0, "header", "missing"},
        {header + "\n", 0, "", "no modes"},
        {"# c\nfrequency,damping\n", 2, "header", "load.ux"},
        {header + "\n" + row + ",1\n", 2, "", "12 cells"},
        {header + "\n34.5,0.01,1\n", 2, "", "3 cells"},
        {header + "\n" + row + "\n0" + row.substr(4), 3, "frequency [Hz]", "above 0"},
        {header + "\n-3" + row.substr(4), 2, "frequency [Hz]", "above 0"},
        {header + "\n34.5,-0.01" + row.substr(9), 2, "damping_ratio", "from 0"},
        {header + "\n34.5,nan" + row.substr(9), 2, "damping_ratio", "finite"},
        {header + "\n34.5,0.01,inf,2,3,4,5,6,7,8,9", 2, "ux", "finite"},
        {header + "\n34.5,0.01,1e999,2,3,4,5,6,7,8,9", 2, "ux", "finite"},
        {header + "\n34.5,0.01,1,2,,4,5,6,7,8,9", 2, "uz", "empty"},
        {header + "\n34.5,0.01,1,2,3,4,5,6,7,8,9 N", 2, "load.uz", "9 N"},
        {header + "\n34.5,0.01,1,2,3,4,5,+-6,7,8,9", 2, "rz", "+-6"},
    }));
    CAPTURE(bad.text);
    try {
        parseBracketModes(bad.text, "m.csv");
        FAIL("was accepted");
    } catch (const InputError& error) {
        CHECK(error.location().file == "m.csv");
        CHECK(error.location().line == bad.line);
        CHECK(error.location().key == bad.key);
        CHECK_THAT(error.what(), Catch::Contains(bad.part));
    }
}

TEST_CASE("modes file: a long cell is shown up to its sixtieth character") {
    const std::string whole(60, 'x');
    const auto refuse = [&](const std::string& cell) {
        try {
            parseBracketModes(header + "\n" + cell + row.substr(row.find(',')), "m.csv");
        } catch (const InputError& error) {
            return error.problem();
        }
        return std::string("read");
    };
    CHECK(refuse(whole) == "is \"" + whole + "\"");
    CHECK(refuse(whole + "y") == "is \"" + whole + "…\"");
}

TEST_CASE("modes file: one that is not there") {
    CHECK_THROWS_WITH(readBracketModes("/nowhere/modes.csv"),
                      Catch::Contains("/nowhere/modes.csv: there is no such file"));
}
