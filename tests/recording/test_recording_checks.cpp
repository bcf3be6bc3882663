#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "models/common/error.hpp"
#include "models/common/units.hpp"
#include "models/recording/recording_checks.hpp"

using namespace wems;
using Catch::Contains;

namespace {

const double nan_value = std::numeric_limits<double>::quiet_NaN();

/// Two connections' axial motion, 400 samples at 1 kHz; the first sample stands in row 2 of the file.
Recording makeSweep() {
    Recording recording;
    recording.file = "run.csv";
    recording.first_row = 2;
    recording.channels = {{"mobile.1.z", "mm", {}, 2}, {"mobile.2.z", "mm", {}, 3}, {"load.fz", "N", {}, 4}};
    for (int i = 0; i < 400; ++i) {
        const double t = 1e-3 * i;
        recording.time.push_back(t);
        recording.channels[0].values.push_back(1.0e-3 * std::sin(kTwoPi * 20 * t));
        recording.channels[1].values.push_back(0.8e-3 * std::sin(kTwoPi * 20 * t + 0.3));
        recording.channels[2].values.push_back(200 * std::cos(kTwoPi * 20 * t));
    }
    return recording;
}

const Finding* find(const std::vector<Finding>& findings, FindingKind kind) {
    const auto found = std::find_if(findings.begin(), findings.end(), [&](const Finding& f) { return f.kind == kind; });
    return found == findings.end() ? nullptr : &*found;
}

/// The only finding, of this kind, channel and row.
void checkOnly(const std::vector<Finding>& findings, FindingKind kind, const std::string& channel, long row,
               const std::string& text) {
    for (const auto& finding : findings) INFO(finding.message);
    REQUIRE(findings.size() == 1);
    CHECK(findings[0].kind == kind);
    CHECK(findings[0].channel == channel);
    CHECK(findings[0].row == row);
    CHECK_THAT(findings[0].message, Contains(channel) && Contains(text));
}

}  // namespace

TEST_CASE("A clean recording has no findings") {
    auto recording = makeSweep();
    SECTION("as it is") {}
    SECTION("printed to few digits, so that peaks stay on one value") {
        for (auto& channel : recording.channels) {
            for (auto& v : channel.values) v = std::round(v * 1e5) / 1e5;
        }
    }
    SECTION("with noise, coarsely digitised") {
        std::mt19937 random(5);
        std::normal_distribution<> noise(0, 1e-5);
        for (auto& v : recording.channels[0].values) v = std::round((v + noise(random)) / 4e-5) * 4e-5;
    }
    SECTION("at rest: the whole fixed part, an axis in which nothing moves, a load in one direction") {
        for (const auto* name : {"fixed.1.z", "fixed.2.z", "mobile.1.x", "mobile.2.x", "load.fx"})
            recording.channels.push_back({name, "m", std::vector<double>(400, 0.0), 0});
    }
    SECTION("half-sine loads with rest between") {
        for (auto& v : recording.channels[2].values) v = std::max(0.0, v);
    }
    SECTION("time printed to 6 digits after 1000 s") {
        for (auto& t : recording.time) t = std::round((1000 + t) * 1e6) / 1e6;
    }
    const auto findings = repairAndCheck(recording);
    for (const auto& finding : findings) INFO(finding.message);
    CHECK(findings.empty());
}

TEST_CASE("Repeated stamps are dropped and later rows keep their numbers") {
    auto recording = makeSweep();
    recording.time[10] = recording.time[9];
    recording.time[20] = recording.time[19];
    for (std::size_t i = 100; i < 110; ++i) recording.channels[0].values[i] = 0.6e-3;  // no extreme, no finding
    const double next = recording.channels[0].values[11];
    const auto findings = repairAndCheck(recording);
    CHECK(recording.sampleCount() == 398);
    CHECK(recording.channels[0].values.size() == 398);
    CHECK(recording.channels[0].values[10] == next);
    REQUIRE(find(findings, FindingKind::repeated_time) != nullptr);
    CHECK(find(findings, FindingKind::repeated_time)->row == 12);
    CHECK_THAT(find(findings, FindingKind::repeated_time)->message, Contains("2 rows, 12, 22"));
    // The dropped rows leave two gaps; the second is before row 23 of the file.
    REQUIRE(find(findings, FindingKind::gap) != nullptr);
    CHECK(find(findings, FindingKind::gap)->row == 13);
    CHECK_THAT(find(findings, FindingKind::gap)->message, Contains("2 gaps"));
}

TEST_CASE("A stamp that goes back is dropped, many are an error") {
    auto recording = makeSweep();
    recording.time[50] = 0.001;
    SECTION("one") {
        const auto findings = repairAndCheck(recording);
        REQUIRE(find(findings, FindingKind::backward_time) != nullptr);
        CHECK(find(findings, FindingKind::backward_time)->row == 52);
        CHECK(std::is_sorted(recording.time.begin(), recording.time.end()));
    }
    SECTION("one stamp far ahead makes all later ones go back") {
        recording.time[50] = 1e6;
        CHECK_THROWS_WITH(repairAndCheck(recording), Contains("run.csv:53: time: time goes back"));
    }
    SECTION("more than a tenth repeated") {
        for (std::size_t i = 100; i < 200; i += 2) recording.time[i] = recording.time[i - 1];
        CHECK_THROWS_WITH(repairAndCheck(recording), Contains("run.csv:102: time: 50 of 400 time stamps repeat"));
    }
}

TEST_CASE("Gaps and uneven stamps") {
    auto recording = makeSweep();
    SECTION("gap") {
        for (std::size_t i = 200; i < 400; ++i) recording.time[i] += 0.05;
        checkOnly(repairAndCheck(recording), FindingKind::gap, "time", 202,
                  "1 gap, the longest 0.051 s before row 202");
    }
    SECTION("jitter") {
        recording.time[30] += 1e-4;
        checkOnly(repairAndCheck(recording), FindingKind::non_uniform_time, "time", 32, "2 of 399 intervals");
    }
}

TEST_CASE("Empty fields") {
    auto recording = makeSweep();
    auto& values = recording.channels[0].values;
    SECTION("up to five on end are interpolated") {
        const auto truth = values;
        for (std::size_t i = 100; i < 105; ++i) values[i] = nan_value;
        values[7] = nan_value;
        checkOnly(repairAndCheck(recording), FindingKind::missing_value, "mobile.1.z", 9,
                  "6 rows, 9, 102, 103, 104, 105");
        CHECK(values[102] == Approx((truth[99] + truth[105]) / 2));
        CHECK(values[7] == Approx((truth[6] + truth[8]) / 2));
        CHECK(values[106] == truth[106]);
    }
    SECTION("six are an error") {
        for (std::size_t i = 100; i < 106; ++i) values[i] = nan_value;
        CHECK_THROWS_WITH(repairAndCheck(recording), Contains("run.csv:102: mobile.1.z: no value in 6 rows on end"));
    }
    SECTION("at start and end the rows go") {
        values[0] = values[1] = nan_value;
        recording.channels[1].values[399] = nan_value;
        const double first = values[2];
        const auto findings = repairAndCheck(recording);
        CHECK(recording.sampleCount() == 397);
        CHECK(recording.first_row == 4);
        CHECK(recording.channels[0].values.front() == first);
        REQUIRE(findings.size() == 2);
        CHECK_THAT(findings[0].message, Contains("mobile.1.z: no values in the first 2 rows (from row 2)"));
        CHECK_THAT(findings[1].message, Contains("mobile.2.z: no values in the last 1 rows (from row 401)"));
    }
    SECTION("a cut that bares the empty field of another channel goes on") {
        values[0] = values[2] = nan_value;
        recording.channels[1].values[1] = nan_value;
        recording.channels[1].values[399] = recording.channels[2].values[398] = nan_value;
        repairAndCheck(recording);
        CHECK(recording.sampleCount() == 395);
        CHECK(recording.first_row == 5);
    }
    SECTION("more than half of the rows are an error") {
        std::fill(values.begin() + 150, values.end(), nan_value);
        CHECK_THROWS_WITH(repairAndCheck(recording), Contains("run.csv:152: mobile.1.z: more than half"));
    }
    SECTION("a channel without any value is dropped") {
        std::fill(values.begin(), values.end(), nan_value);
        checkOnly(repairAndCheck(recording), FindingKind::empty_channel, "mobile.1.z", 0, "no values");
        CHECK(recording.find("mobile.1.z") == nullptr);
    }
}

TEST_CASE("Clipped channels") {
    auto recording = makeSweep();
    auto& values = recording.channels[0].values;
    SECTION("on one side") {
        for (auto& v : values) v = std::min(v, 0.7e-3);
        // sin first exceeds 0.7 at t = asin(0.7)/(2π 20) = 6.17 ms: sample 7, row 9; eight periods in 0.4 s.
        checkOnly(repairAndCheck(recording), FindingKind::clipped, "mobile.1.z", 9,
                  "largest value 0.0007 (SI) 8 times");
    }
    SECTION("on the other, hardly") {
        for (auto& v : values) v = std::max(v, -0.97e-3);
        checkOnly(repairAndCheck(recording), FindingKind::clipped, "mobile.1.z", 38, "smallest value -0.00097 (SI) 8");
    }
}

TEST_CASE("A constant channel beside one that moves") {
    auto recording = makeSweep();
    std::fill(recording.channels[1].values.begin(), recording.channels[1].values.end(), 1e-4);
    checkOnly(repairAndCheck(recording), FindingKind::constant, "mobile.2.z", 2,
              "constant at 0.0001 while mobile.1.z moves");
}
