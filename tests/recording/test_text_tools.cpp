// What the readers and writers of text share: lines, fields, numbers, headers, zlib streams.
#include <zlib.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "models/common/error.hpp"
#include "models/recording/column_map.hpp"
#include "models/recording/line_cursor.hpp"
#include "models/recording/mat_file.hpp"
#include "models/recording/recording_writer.hpp"
#include "tests/seed.hpp"

using namespace wems;
using Catch::Contains;

TEST_CASE("lines of a text, with either end, counted; fields by tabs or blanks") {
    LineCursor lines("one\r\ntwo\n\nfour");
    for (const char* expected : {"one", "two", "", "four"}) {
        REQUIRE_FALSE(lines.atEnd());
        CHECK(lines.take() == expected);
    }
    CHECK(lines.atEnd());
    CHECK(lines.line() == 4);
    LineCursor skipped("abcdef\ng");
    skipped.skip(4);
    CHECK(skipped.take() == "ef");
    skipped.skip(1000);
    CHECK(skipped.atEnd());
    using Fields = std::vector<std::string_view>;
    CHECK(splitFields("a\t\tb c\t") == Fields{"a", "", "b c", ""});
    CHECK(splitFields("  a  b c ") == Fields{"a", "b", "c"});
    CHECK(estimateRows(std::string(1000, 'x') + "\n") == Approx(1).margin(1));
    std::string many;
    for (int i = 0; i < 300000; ++i) many += "12345678\n";
    CHECK(estimateRows(many) == Approx(300000).epsilon(0.01));
}

TEST_CASE("rows of numbers: gaps, vectors, what is none and a wrong length by its line") {
    LineCursor lines("1\t\t3\n4\tnan\t6\n7\t8\n", 10);
    const auto columns = readNumberRows(lines, 3, "run.sto");
    REQUIRE(columns.size() == 3);
    CHECK(columns[0] == std::vector<double>{1, 4, 7});
    CHECK(std::isnan(columns[1][0]));
    CHECK(std::isnan(columns[1][1]));
    CHECK(std::isnan(columns[2][2]));
    LineCursor vectors("0\t1,2,3\n");
    CHECK(readNumberRows(vectors, 4, "run.sto")[3] == std::vector<double>{3});
    LineCursor two("1\n2\n3\n");
    CHECK(readNumberRows(two, 1, "run.sto", 2)[0] == std::vector<double>{1, 2});
    CHECK(two.take() == "3");
    for (const char* bad : {"1\t2\t3\n1\tx\t3\n", "1\t2\t3\n1\t2\t3\t4\n"}) {
        LineCursor wrong(bad);
        CHECK_THROWS_WITH(readNumberRows(wrong, 3, "run.sto"), Contains("run.sto:2"));
    }
}

TEST_CASE("numbers are written with so many digits, a gap as nothing, an infinity never") {
    std::string text = "a";
    appendNumber(1.0 / 3, 4, text);
    CHECK(text == "a0.3333");
    appendNumber(std::nan(""), 4, text);
    CHECK(text == "a0.3333");
    CHECK_THROWS_AS(appendNumber(std::numeric_limits<double>::infinity(), 4, text), std::invalid_argument);
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<> normal;
    for (int i = 0; i < 1000; ++i) {
        const double value = normal(random) * std::pow(10.0, 20 * normal(random));
        std::string written;
        appendNumber(value, 17, written);
        CHECK(std::strtod(written.c_str(), nullptr) == value);
        written.clear();
        appendNumber(value, 9, written);
        CHECK(std::strtod(written.c_str(), nullptr) == Approx(value).epsilon(1e-8));
    }
    CHECK(parseValidName({"mobile.4.az", "m/s^2", {}, 0}).axis == 2);
    CHECK_THROWS_AS(parseValidName({"somewhere", "m", {}, 0}), std::invalid_argument);
    Recording rows;
    rows.time = {0, 1};
    rows.channels = {{"load.fx", "N", {1, 2}, 0}};
    CHECK_NOTHROW(checkRows(rows, 1));
    CHECK_THROWS_AS(checkRows(rows, 2), std::invalid_argument);
    rows.channels[0].values.pop_back();
    CHECK_THROWS_AS(checkRows(rows, 1), std::invalid_argument);
}

TEST_CASE("headers of columns: name and unit apart") {
    const auto parse = [](const char* text, bool parentheses) { return parseColumnHeader(text, parentheses); };
    CHECK(parse("mobile.1.x [mm]", false).name == "mobile.1.x");
    CHECK(parse("mobile.1.x [mm]", false).unit == "mm");
    CHECK_FALSE(parse("Ch 3", false).has_unit);
    CHECK(parse("Ch 3 (g)", true).unit == "g");
    CHECK_FALSE(parse("Ch 3 (g)", false).has_unit);
    CHECK(isKnownColumn("load.fz [N]", nullptr));
    CHECK(isKnownColumn("time [s]", nullptr));
    CHECK_FALSE(isKnownColumn("temperature [K]", nullptr));
}

TEST_CASE("zlib streams: whole ones to the byte, cut and damaged ones as far as they go") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::string plain;
    for (int i = 0; i < 200000; ++i) plain += static_cast<char>(random() % 7 == 0 ? random() % 256 : 'a');
    std::vector<Bytef> stream(compressBound(plain.size()));
    uLongf size = stream.size();
    REQUIRE(compress(stream.data(), &size, reinterpret_cast<const Bytef*>(plain.data()), plain.size()) == Z_OK);
    const std::string packed(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(size));
    const Inflated whole = inflateAll(packed);
    CHECK(whole.complete);
    CHECK(whole.plain == plain);
    const Inflated cut = inflateAll(std::string_view(packed).substr(0, packed.size() / 2));
    CHECK_FALSE(cut.complete);
    CHECK(cut.plain == plain.substr(0, cut.plain.size()));
    CHECK(cut.plain.size() > plain.size() / 4);
    std::string damaged = packed;
    damaged.back() = static_cast<char>(damaged.back() ^ 1);  // of the checksum
    CHECK_FALSE(inflateAll(damaged).complete);
    CHECK_FALSE(inflateAll("no stream at all").complete);
    CHECK_FALSE(inflateAll("").complete);
}
