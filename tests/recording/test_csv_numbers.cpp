#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "models/common/error.hpp"
#include "models/recording/csv_reader.hpp"

using namespace wems;

namespace {

/// The values of a channel in metres whose fields, in one row each, are these texts.
std::vector<double> readFields(const std::vector<std::string>& fields, char separator = ',') {
    std::string text = std::string("time [s]") + separator + "mobile.1.x [m]" + separator + "load.fz [N]\n";
    for (std::size_t i = 0; i < fields.size(); ++i)
        text += std::to_string(i) + separator + fields[i] + separator + fields[i] + "\n";
    const Recording recording = parseRecording(text, "run.csv");
    REQUIRE(recording.channels.size() == 2);
    REQUIRE(recording.channels[1].values == recording.channels[0].values);  // inside a row and at its end
    return recording.channels[0].values;
}

}  // namespace

TEST_CASE("Numbers of a table are the C library's to the last bit") {
    const unsigned seed = 20240612;
    CAPTURE(seed);
    std::mt19937 random(seed);
    const char* formats[] = {"%.0f", "%.1f", "%.5f", "%.9f", "%.4e", "%.9g", "%.13g", "%.3E", "%.17g", "%.25f"};
    std::vector<std::string> fields;
    for (int i = 0; i < 50000; ++i) {
        const double size = std::pow(10.0, std::uniform_real_distribution<>(-8, 6)(random));
        char text[64];
        std::snprintf(text, sizeof text, formats[random() % 10],
                      size * std::uniform_real_distribution<>(-1, 1)(random));
        fields.push_back(text);
    }
    const std::vector<double> values = readFields(fields);
    REQUIRE(values.size() == fields.size());
    std::size_t differing = 0;
    for (std::size_t i = 0; i < fields.size(); ++i) differing += values[i] != std::strtod(fields[i].c_str(), nullptr);
    CHECK(differing == 0);
}

TEST_CASE("Signs, leading zeros, missing digits on one side, a decimal comma") {
    struct Case {
        const char* text;
        double value;
        char separator;
    };
    const auto c = GENERATE(values<Case>({{"0", 0, ','},
                                          {".5", 0.5, ','},
                                          {"5.", 5, ','},
                                          {"-.25", -0.25, ','},
                                          {"007", 7, ','},
                                          {"1,5", 1.5, ';'},
                                          {"1e+3", 1000, ','},
                                          {"1E-3", 1e-3, ','},
                                          {"+1", 1, ','},
                                          {" 1 ", 1, ','},
                                          {"12345678", 12345678, ','},
                                          {"1e23", 1e23, ','},
                                          {"1e-40", 1e-40, ','},
                                          {"0.00000000000001", 1e-14, ','}}));
    INFO(c.text);
    const std::vector<double> values = readFields({c.text, c.text}, c.separator);
    CHECK(values == std::vector<double>{c.value, c.value});
}

TEST_CASE("A field that is a number only at its start is no number") {
    const auto* text = GENERATE("1.5x", "1.2.3", "1-2", "--1", "12;3", "-", ".", "abc", "1e", "1e+", "1e1234", "inf");
    INFO(text);
    CHECK_THROWS_AS(readFields({"0", text}), InputError);
}
