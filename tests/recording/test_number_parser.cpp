#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include "models/recording/number_parser.hpp"

using wems::NumberParser;

namespace {

/// Parses a number followed by a comma and enough other text.
const char* parse(const std::string& text, const std::string& padded, double& value, char decimal = '.') {
    const char* end = NumberParser(decimal).parse(padded.data(), padded.data() + padded.size(), value);
    return end == nullptr ? nullptr : end - text.size();
}

std::string pad(const std::string& text) {
    return text + "," + std::string(64, '7');
}

}  // namespace

TEST_CASE("Short numbers are the C library's to the last bit") {
    const unsigned seed = 20240612;
    CAPTURE(seed);
    std::mt19937 random(seed);
    const char* formats[] = {"%.0f", "%.1f", "%.5f", "%.9f", "%.4e", "%.9g", "%.13g", "%.3E"};
    int taken = 0;
    for (int i = 0; i < 200000; ++i) {
        const double size = std::pow(10.0, std::uniform_real_distribution<>(-8, 6)(random));
        char text[64];
        std::snprintf(text, sizeof text, formats[random() % 8], size * std::uniform_real_distribution<>(-1, 1)(random));
        const std::string padded = pad(text);
        double value = 0;
        const char* end = parse(text, padded, value);
        // A field in its row, eight characters and more before it.
        const std::string row = "time,1.5," + padded;
        double field = 0;
        const char* field_end = NumberParser('.').parseField(row.data() + 9, row.data() + row.size(), field);
        REQUIRE((field_end == nullptr) == (end == nullptr));
        if (end == nullptr) continue;
        REQUIRE(field_end == row.data() + 9 + std::string(text).size());
        REQUIRE(field == value);
        ++taken;
        if (end != padded.data() || value != std::strtod(text, nullptr)) {
            INFO(text);
            REQUIRE(end == padded.data());
            REQUIRE(value == std::strtod(text, nullptr));
        }
    }
    CHECK(taken > 180000);
}

TEST_CASE("Signs, leading zeros, missing digits on one side, a decimal comma") {
    struct Case {
        const char* text;
        double value;
        char decimal;
    };
    const auto c = GENERATE(values<Case>({{"0", 0, '.'},
                                          {"-0.0", 0, '.'},
                                          {".5", 0.5, '.'},
                                          {"5.", 5, '.'},
                                          {"-.25", -0.25, '.'},
                                          {"007", 7, '.'},
                                          {"1,5", 1.5, ','},
                                          {"1e+3", 1000, '.'},
                                          {"1E-3", 1e-3, '.'},
                                          {"0.00000000000001", 1e-14, '.'}}));
    INFO(c.text);
    double value = -1;
    const std::string padded = std::string(c.text) + ";" + std::string(64, '7');
    const char* end = NumberParser(c.decimal).parse(padded.data(), padded.data() + padded.size(), value);
    REQUIRE(end != nullptr);
    CHECK(*end == ';');
    CHECK(value == c.value);
    CHECK(std::signbit(value) == (c.text[0] == '-'));
}

TEST_CASE("A field that is a number only at its start is no number") {
    const auto* text = GENERATE("1.5x", "1.2.3", "1-2", "--1", "1 ", "1.5\"", "12;3");
    INFO(text);
    double value = 0;
    const std::string row = "time,1.5," + pad(text);
    CHECK(NumberParser('.').parseField(row.data() + 9, row.data() + row.size(), value) == nullptr);
}

TEST_CASE("What is not a short number is left to the general parser") {
    const auto* text = GENERATE("", "-", ".", "+1", " 1", "nan", "inf", "abc", "12345678", "1234567.1234567890", "1e",
                                "1e+", "1e23", "1e-40", "1e1234", "0.12345678901234567890");
    INFO(text);
    double value = 0;
    CHECK(parse(text, pad(text), value) == nullptr);
    const std::string row = "time,1.5," + pad(text);
    CHECK(NumberParser('.').parseField(row.data() + 9, row.data() + row.size(), value) == nullptr);
    const std::string near_end = "1.5,";
    CHECK(parse(near_end, near_end, value) == nullptr);
}
