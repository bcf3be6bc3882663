// simulate --response as a user calls it, and against Simbody's time integration.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include "models/recording/recording_reader.hpp"
#include "tests/plugin/simulate_command.hpp"

using namespace wems::test;

namespace {

/// Half of what lies between the ends of mobile − fixed in a second of a dwell that grew slowly, so that it follows the
/// curve from the low level up: where several motions are possible, a sudden start may lead to another one.
double measureDwell(const TemporaryDirectory& folder, const std::string& model, const std::string& level_option,
                    const std::string& level, double f, const std::string& channel) {
    runSimulate(folder, {model, "--dwell", std::to_string(f) + ":9", "--fade", "2", level_option, level, "--channels",
                         "displacement", "--sample-rate", "4000", "--quiet", "-o", "dwell.csv"});
    const wems::Recording run = wems::readRecording(folder.path() + "/dwell.csv");
    const auto& mobile = run.find("mobile." + channel)->values;
    const auto& fixed = run.find("fixed." + channel)->values;
    double highest = -1e9, lowest = 1e9;
    for (std::size_t k = 24000; k < 28000; ++k) {  // 6 to 7 s
        highest = std::max(highest, mobile[k] - fixed[k]);
        lowest = std::min(lowest, mobile[k] - fixed[k]);
    }
    return 0.5 * (highest - lowest);
}

/// Amplitudes of one axis on the stable parts of a curve, by straight lines between points.
std::vector<double> findStable(const Json& level, std::size_t axis, double f) {
    std::vector<double> found;
    const Json& points = level.at("points");
    for (std::size_t i = 1; i < points.size(); ++i) {
        const double a = points[i - 1].at("frequency"), b = points[i].at("frequency");
        if ((a - f) * (b - f) > 0 || !points[i - 1].at("stable").get<bool>()) continue;
        const double u = (f - a) / (b - a);
        found.push_back((1 - u) * points[i - 1].at("amplitude")[axis].get<double>() +
                        u * points[i].at("amplitude")[axis].get<double>());
    }
    return found;
}

}  // namespace

TEST_CASE("response curves agree with time integration, in contact too") {
    struct Case {
        std::string model, option, level, channel;
        std::size_t axis;
        std::vector<double> frequencies;
    };
    const Case c = GENERATE(values<Case>({
        {single_axis, "--base-acceleration", "z=6", "mount.z", 2, {9, 14, 17, 30, 47}},
        {smallsat, "--force", "z=300", "4.z", 11, {11.2, 30.8, 33, 37}},
    }));
    const TemporaryDirectory folder;
    const Json level = runJson(folder, {c.model, "--response", "8:50", c.option, c.level}).at("levels")[0];
    CHECK(level.at("incomplete") == "");
    CHECK(level.at("folds").size() == 2);
    for (const double f : c.frequencies) {
        const double expected = measureDwell(folder, c.model, c.option, c.level, f, c.channel);
        const std::vector<double> stable = findStable(level, c.axis, f);
        CAPTURE(c.model, f, expected, stable);
        REQUIRE_FALSE(stable.empty());
        double nearest = 1e9;
        for (const double amplitude : stable)
            if (std::abs(amplitude - expected) < std::abs(nearest - expected)) nearest = amplitude;
        CHECK(nearest == Approx(expected).epsilon(5e-3));
    }
}

TEST_CASE("response curves: levels, units, files") {
    const TemporaryDirectory folder;
    const auto result =
        runSimulate(folder, {single_axis, "--response", "12:20", "--base-acceleration", "z=0.05g,0.3g", "--harmonics",
                             "7", "--json", "response.json", "--report", "response.html", "-o", "response.csv"});
    CHECK(result.output.find("base acceleration z=0.490333 m/s^2") != std::string::npos);
    CHECK(result.output.find("mount.z.+") != std::string::npos);
    CHECK(folder.list() == std::vector<std::string>{"response.csv", "response.html", "response.json"});
    std::ifstream file(folder.path() + "/response.json");
    const Json json = Json::parse(file);
    REQUIRE(json.at("levels").size() == 2);
    CHECK(json.at("axes")[2] == "mount.z");
    CHECK(json.at("levels")[1].at("harmonics") == 7);
}

TEST_CASE("wrong uses of --response: one line, exit status 2, no file") {
    const TemporaryDirectory folder;
    const auto arguments = GENERATE(values<std::vector<std::string>>({
        {single_axis, "--response", "12:20"},
        {single_axis, "--response", "20:12", "--base-acceleration", "z=1"},
        {single_axis, "--response", "12", "--base-acceleration", "z=1"},
        {single_axis, "--response", "12:20", "--base-acceleration", "z"},
        {single_axis, "--response", "12:20", "--base-acceleration", "z=1,"},
        {single_axis, "--response", "12:20", "--base-acceleration", "z=1,q"},
        {single_axis, "--response", "12:20", "--base-acceleration", "z=1", "--force", "z=1"},
        {single_axis, "--response", "12:20", "--base-acceleration", "z=1", "--modes"},
        {single_axis, "--response", "12:20", "--base-acceleration", "z=1", "--dwell", "5:1"},
        {single_axis, "--response", "12:20", "--base-acceleration", "z=1", "--harmonics", "0"},
        {single_axis, "--response", "12:20", "--force", "z=1"},
        {single_axis, "--dwell", "12:1", "--base-acceleration", "z=1,2"},
    }));
    checkRefused(folder, arguments);
}
