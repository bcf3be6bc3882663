#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/inspect/inspection.hpp"
#include "tests/inspect/planted_run.hpp"

namespace wems::identify {
namespace {

bool anyContains(const std::vector<std::string>& lines, const std::string& text) {
    return std::any_of(lines.begin(), lines.end(),
                       [&](const std::string& line) { return line.find(text) != std::string::npos; });
}

/// Three connections not on one line.
MountModel makeModel() {
    return parseMountModel(
        "[body]\nmass = 2.0\ninertia = [0.01, 0.01, 0.01]\n"
        "[[connection]]\nname = \"1\"\nposition = [0.1, 0.0, 0.0]\n[connection.z]\nstiffness = 1.0e4\n"
        "stops = [ { side = \"+\", clearance = 1.0e-4, stiffness = 1.0e5 }, { side = \"-\", clearance = 1.0, stiffness "
        "= "
        "1.0e5 } ]\n"
        "[[connection]]\nname = \"2\"\nposition = [-0.1, 0.0, 0.0]\n[connection.z]\nstiffness = 1.0e4\n"
        "[[connection]]\nname = \"3\"\nposition = [0.0, 0.1, 0.0]\n[connection.z]\nstiffness = 1.0e4\n",
        "model.toml");
}

}  // namespace

TEST_CASE("Levels, noise and band of a channel") {
    const unsigned seed = 11;
    INFO("seed " << seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, 2e-6);
    Recording run;
    Channel z{"mobile.1.z", "mm", {}, 2};
    for (int k = 0; k < 20000; ++k) {
        run.time.push_back(k / 1000.0);
        z.values.push_back(1e-3 * std::sin(2 * 3.14159265358979 * 20 * k / 1000.0) + noise(random));
    }
    run.channels = {z};
    const Inspection inspection = inspect(run, nullptr);
    CHECK(inspection.rate == Approx(1000));
    CHECK(inspection.duration == Approx(19.999));
    REQUIRE(inspection.channels.size() == 1);
    const ChannelStatistics& channel = inspection.channels.front();
    CHECK(channel.unit == "m");
    CHECK(channel.rms == Approx(1e-3 / std::sqrt(2.0)).epsilon(1e-3));
    CHECK(channel.noise == Approx(2e-6).epsilon(0.05));
    CHECK(channel.signal_to_noise == Approx(20 * std::log10(1e-3 / std::sqrt(2.0) / 2e-6)).margin(0.5));
    CHECK(channel.band_from == Approx(20).margin(0.5));
    CHECK(channel.band_to == Approx(20).margin(0.5));
    CHECK(inspection.swept.is_sine);
    CHECK(inspection.findings.empty());
    CHECK(anyContains(inspection.abilities, "neither load nor base is recorded"));
}

TEST_CASE("What can be identified depends on the channels and the model") {
    std::mt19937 random(5);
    const Recording run = test::makeSweptRun(random);
    const Inspection without = inspect(run, nullptr);
    CHECK(anyContains(without.abilities, "the load is recorded and is used as it was"));
    CHECK(anyContains(without.abilities, "mobile part: 2 displacement channels"));
    const MountModel model = makeModel();
    const Inspection with = inspect(run, &model);
    CHECK(anyContains(with.abilities, "which leave open its translation y"));
    const bool missing = std::any_of(with.findings.begin(), with.findings.end(), [](const Finding& finding) {
        return finding.kind == FindingKind::missing_connection && finding.channel == "mobile.2";
    });
    CHECK(missing);
}

TEST_CASE("Stops are reached or not") {
    const MountModel model = makeModel();
    Recording run;
    for (int k = 0; k < 3000; ++k) run.time.push_back(k / 1000.0);
    for (const char* connection : {"1", "2", "3"}) {
        for (const char* axis : {".x", ".y", ".z"}) {
            Channel channel{std::string("mobile.") + connection + axis, "m", {}, 0};
            for (const double t : run.time)
                channel.values.push_back(axis[1] == 'z' ? 2e-4 * std::sin(2 * 3.14159265358979 * 20 * t) : 0.0);
            run.channels.push_back(std::move(channel));
        }
    }
    const Inspection inspection = inspect(run, &model);
    CHECK(
        anyContains(inspection.abilities, "9 displacement channels, which determine all six motions with 3 to spare"));
    CHECK(anyContains(inspection.abilities, "stops reached with the model's clearances: 1.z.+"));
    CHECK(anyContains(inspection.abilities, "stops not reached, so that nothing can be said of them: 1.z.-"));
}

TEST_CASE("A recording of a few rows is shown without a judgement of its signals") {
    Recording run;
    run.time = {0, 0.1, 0.2};
    run.channels = {{"force.a.z", "N", {1, 2, 3}, 2}, {"relative.a.z", "m", {1e-3, 2e-3, 3e-3}, 3}};
    const Inspection inspection = inspect(run, nullptr);
    CHECK(inspection.channels.size() == 2);
    CHECK(inspection.findings.empty());
    CHECK(anyContains(inspection.abilities, "its law can be fitted directly"));
}

}  // namespace wems::identify
