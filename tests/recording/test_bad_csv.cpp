// Bad recordings: one line that says file, row, column, what is wrong and what is accepted.
#include <catch2/catch.hpp>
#include <filesystem>

#include "models/common/error.hpp"
#include "models/recording/csv_reader.hpp"
#include "models/recording/recording_reader.hpp"
#include "tests/recording/temporary_file.hpp"

using namespace wems;
using Catch::Contains;
using Catch::StartsWith;

namespace {

struct BadText {
    std::string text;
    long row;
    std::string column, problem;
};

const std::string header = "time [s],mobile.1.x [mm],load.fz [N]\n";
const std::string rows = "0,1,2\n1,2,3\n2,3,4\n";

std::string manyRows(int count, const std::string& tail) {
    std::string text = header;
    for (int i = 0; i < count; ++i) text += std::to_string(i) + tail;
    return text;
}

}  // namespace

TEST_CASE("Bad recordings are refused with row and column") {
    const auto bad = GENERATE(values<BadText>({
        {header + "0,1,2\n1,abc,3\n", 3, "mobile.1.x", "'abc' is not a number"},
        {header + "0,1,2\n1,1.2.3,3\n", 3, "mobile.1.x", "'1.2.3' is not a number"},
        {header + "0,1,2\n1,1e999,3\n", 3, "mobile.1.x", "not"},
        {header + "0,1,2\n1,inf,3\n", 3, "mobile.1.x", "'inf' is not finite"},
        {header + "0,1,0x1F\n", 2, "load.fz", "'0x1F' is not a number"},
        {header + "0,1,2\n,2,3\n", 3, "time", "the row has no time"},
        {header + "0,1,2\nnan,2,3\n", 3, "time", "the row has no time"},
        {header + "0,1,2\n1,2\n", 3, "", "the row has 2 fields, the header has 3"},
        {header + "0,1,2\n1,2,3,4\n", 3, "", "the row has 4 fields, the header has 3"},
        {header + "0,1,2\n1,2,\"3\",4\n", 3, "", "the row has 4 fields, the header has 3"},
        {header + "0,1,2\n1\n", 3, "", "the row has 1 fields, the header has 3"},
        {header + "0,1,2\n\n1,2,3\n", 3, "", "blank row inside the data"},
        {header + "0,1,2\n1,\"2,3\n", 3, "", "a quote is not closed"},
        {"\"time [s],mobile.1.x [mm]\n0,1\n", 1, "", "a quote in the header row is not closed"},
        {header, 1, "", "no data rows"},
        {header + "\n\n", 1, "", "no data rows"},
        {header + ",,\n", 1, "", "no data rows"},
        {"# only: metadata\n", 0, "", "there is no header row"},
        {"mobile.1.x [mm],load.fz [N]\n" + rows, 1, "time", "there is no time column"},
        {"time,mobile.1.x [mm],load.fz [N]\n" + rows, 1, "time", "column 'time' has no unit"},
        {"# a: b\ntime [s],mobile.1.x,load.fz [N]\n" + rows, 2, "mobile.1.x", "column 'mobile.1.x' has no unit"},
        {"time [s],mobile.1.x [furlong],load.fz [N]\n" + rows, 1, "mobile.1.x", "accepted: m, mm, um, in"},
        {"time [s],mobile.1.x (mm),load.fz [kg]\n" + rows, 1, "load.fz", "accepted: N, kN, lbf, lb, kip"},
        {"time [s],mobile.1.x [mm],mobile.1.x [m]\n" + rows, 1, "mobile.1.x", "two columns"},
        {"time [s],time [ms],mobile.1.x [m]\n" + rows, 1, "time", "two columns"},
        {"time [s],a,b\n" + rows, 1, "", "no column is a channel"},
        {header + "0,1,2\n3,1,2\n2,1,2\n2,1,2\n1,1,2\n0.5,1,2\n", 4, "time", "time goes back"},
        {header + "0,1,2\n0,1,2\n0,1,2\n1,1,2\n", 3, "time", "2 of 4 time stamps repeat"},
        {header + "0,1,2\n" + "1,,2\n2,,2\n3,,2\n4,,2\n5,,2\n6,,2\n" + "7,1,2\n", 3, "mobile.1.x",
         "no value in 6 rows on end"},
        {header + "0,1,\n1,1,\n2,1,\n3,1,1\n", 2, "load.fz", "more than half of the rows"},
        {header + "0,,\n1,,\n", 2, "", "no channel has a value"},
        {"time [s];mobile.1.x [mm]\n0;1,5\n1;2.5\n", 3, "mobile.1.x", "decimal comma"},
        {manyRows(3000, ",1,2\n") + "3000,x,2\n", 3002, "mobile.1.x", "'x' is not a number"},
        {manyRows(3000, ",1,2\n") + "3000,1\n", 3002, "", "the row has 2 fields"},
    }));
    INFO(bad.text.substr(0, 200));
    try {
        parseRecording(bad.text, "run.csv");
        FAIL("read without error");
    } catch (const InputError& error) {
        CHECK_THAT(error.what(), StartsWith("run.csv") && Contains(bad.problem));
        CHECK(error.location().line == bad.row);
        CHECK(error.location().key == bad.column);
        CHECK(std::string(error.what()).find('\n') == std::string::npos);
    }
}

TEST_CASE("What is no text file is refused by name") {
    struct Case {
        std::string content, problem;
    };
    const auto c = GENERATE(values<Case>({
        {std::string("\x7F"
                     "ELF\x02\x01\x00\x00",
                     8),
         "binary"},
        {std::string("\xFF\xFE\n\0", 4), "there is no header row"},
        {"\x1F\x8B\x08", "compressed"},
        {"PK\x03\x04", "compressed or a spreadsheet"},
        {"", "the file is empty"},
        {"\n\n", "there is no header row"},
    }));
    const test::TemporaryFile file(c.content);
    CHECK_THROWS_WITH(readRecording(file.path()), StartsWith(file.path() + ": ") && Contains(c.problem));
}

TEST_CASE("A file that is not there, a directory") {
    CHECK_THROWS_WITH(readRecording("/no/such/run.csv"), "/no/such/run.csv: there is no such file");
    const auto folder = std::filesystem::temp_directory_path().string();
    CHECK_THROWS_WITH(readRecording(folder), folder + ": is a directory, not a file");
}
