// simulate --response as a user calls it, and against Simbody's time integration.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "models/recording/recording_reader.hpp"
#include "tests/plugin/simulate_command.hpp"

using namespace wems::test;

namespace {

/// A dwell that grew slowly, so that it follows the curve from the low level up: where several motions are possible, a
/// sudden start may lead to another one.
struct Dwell {
    double amplitude = 0;  ///< half of what lies between the ends of mobile − fixed in the last of two equal stretches
    double change = 0;     ///< of the amplitude from the first stretch to the last, over the amplitude
};

/// @param duration s; the stretches are its last seconds but two: one for each eight seconds, each
Dwell measureDwell(const TemporaryDirectory& folder, const std::string& model, const std::string& level_option,
                   const std::string& level, double f, const std::string& channel, int duration = 9) {
    constexpr int rate = 4000;
    runSimulate(folder, {model, "--dwell", std::to_string(f) + ":" + std::to_string(duration), "--fade", "2",
                         level_option, level, "--channels", "displacement", "--sample-rate", std::to_string(rate),
                         "--quiet", "-o", "dwell.csv"});
    const wems::Recording run = wems::readRecording(folder.path() + "/dwell.csv");
    const auto& mobile = run.find("mobile." + channel)->values;
    const auto& fixed = run.find("fixed." + channel)->values;
    const int stretch = std::max(1, duration / 8);
    const auto amplitudeFrom = [&](int second) {
        double highest = -1e9, lowest = 1e9;
        for (int k = second * rate; k < (second + stretch) * rate; ++k) {
            highest = std::max(highest, mobile[k] - fixed[k]);
            lowest = std::min(lowest, mobile[k] - fixed[k]);
        }
        return 0.5 * (highest - lowest);
    };
    const double last = amplitudeFrom(duration - 2 - stretch);
    return {last, std::abs(last / amplitudeFrom(duration - 2 - 2 * stretch) - 1)};
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

double findNearest(const std::vector<double>& amplitudes, double wanted) {
    return *std::min_element(amplitudes.begin(), amplitudes.end(),
                             [&](double a, double b) { return std::abs(a - wanted) < std::abs(b - wanted); });
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
        const double expected = measureDwell(folder, c.model, c.option, c.level, f, c.channel).amplitude;
        const std::vector<double> stable = findStable(level, c.axis, f);
        CAPTURE(c.model, f, expected, stable);
        REQUIRE_FALSE(stable.empty());
        CHECK(findNearest(stable, expected) == Approx(expected).epsilon(5e-3));
    }
}

// Some half an hour: every dwell that settles to one amplitude beside the stable parts of its curve.
TEST_CASE("forty dwells at each of four levels lie on the curves", "[.dwells]") {
    const std::string level = GENERATE("100", "200", "300", "400");
    constexpr int count = 40;
    constexpr std::size_t axis = 11;  // 4.z
    const TemporaryDirectory folder;
    const Json curve = runJson(folder, {smallsat, "--response", "5:50", "--force", "z=" + level}).at("levels")[0];
    int settled = 0, within = 0, modulated = 0;
    for (int k = 0; k < count; ++k) {
        const double f = 5.5 * std::pow(48 / 5.5, k / (count - 1.0));
        Dwell dwell;
        for (const int duration : {12, 40}) {
            dwell = measureDwell(folder, smallsat, "--force", "z=" + level, f, "4.z", duration);
            if (dwell.change < 5e-4) break;
        }
        const std::vector<double> stable = findStable(curve, axis, f);
        const bool steady = dwell.change < 5e-4;
        const double off = stable.empty() ? NAN : findNearest(stable, dwell.amplitude) / dwell.amplitude - 1;
        settled += steady ? 1 : 0;
        within += steady && std::abs(off) < 5e-3 ? 1 : 0;
        modulated += !steady && stable.empty() ? 1 : 0;
        if (!steady || !(std::abs(off) < 5e-3))
            std::printf("%s N, %.3f Hz: %.5g mm, changes by %.2g, %zu stable, curve off by %.2g\n", level.c_str(), f,
                        1e3 * dwell.amplitude, dwell.change, stable.size(), off);
    }
    std::printf("%s N: %d settled, %d of them within 0.5 %%; %d go on changing where no motion is stable\n",
                level.c_str(), settled, within, modulated);
    CHECK(within == settled);
    CHECK(settled + modulated == count);
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
