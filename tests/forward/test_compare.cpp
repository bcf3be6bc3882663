// Comparison of two recordings: errors that are known beforehand, and what does not match.
#include <catch2/catch.hpp>
#include <cmath>

#include "identify/forward/compare.hpp"
#include "models/common/error.hpp"
#include "models/common/units.hpp"
#include "models/excitation.hpp"
#include "tests/forward/forward_fixture.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

void addChannel(Recording& recording, const std::string& name, double gain, double (*signal)(double)) {
    Channel channel;
    channel.name = name;
    for (double t : recording.time) channel.values.push_back(gain * signal(t));
    recording.channels.push_back(channel);
}

double sweep(double t) {
    static const auto signal = makeLogarithmicSweep(5, 45, 6 * std::log2(9.0));
    return signal->value(t);
}

/// Two connections, x and z, with a load that sweeps from 5 to 45 Hz in 10 s.
Recording makeRecording(double interval, double gain_of_1z, const std::string& file) {
    Recording recording;
    recording.file = file;
    for (int k = 0; k <= std::lround(10 / interval); ++k) recording.time.push_back(interval * k);
    for (const char* name : {"1.x", "1.z", "2.x", "2.z"}) {
        const double gain = std::string(name) == "1.z" ? gain_of_1z : 1;
        addChannel(recording, std::string("mobile.") + name, 1.5e-3 * gain, sweep);
        addChannel(recording, std::string("fixed.") + name, 0.5e-3 * gain, sweep);
    }
    addChannel(recording, "load.fz", 100, sweep);
    return recording;
}

Comparison comparePlain(const Recording& measured, const Recording& simulated) {
    return compare(calcRelativeDisplacement(measured), calcRelativeDisplacement(simulated), nullptr);
}

}  // namespace

TEST_CASE("a gain of one channel is its error, and a quarter of the squares makes half of it overall") {
    const Comparison result = comparePlain(makeRecording(1e-3, 1, "m.csv"), makeRecording(1e-3, 1.2, "s.csv"));
    REQUIRE(result.channels.size() == 4);
    CHECK(result.channels[1].name == "1.z");
    CHECK(result.channels[1].error == Approx(0.2));
    CHECK(result.channels[1].share == Approx(1));
    CHECK(result.channels[0].error == Approx(0).margin(1e-12));
    CHECK(result.error == Approx(0.1));
    REQUIRE(result.bands.size() > 4);
    CHECK(result.bands.front().from == Approx(5).epsilon(0.1));
    CHECK(result.bands.back().to == Approx(45).epsilon(0.1));
    for (const BandError& band : result.channels[1].bands) CHECK(band.error == Approx(0.2));
}

TEST_CASE("other sample rates and time ranges are interpolated and cut, and said so") {
    const Recording measured = makeRecording(1e-3, 1, "m.csv");
    Recording simulated = makeRecording(0.7e-3, 1, "s.csv");
    simulated.time.resize(2000);
    for (Channel& channel : simulated.channels) channel.values.resize(2000);
    const Comparison result = comparePlain(measured, simulated);
    CHECK(result.error < 1e-3);
    CHECK(result.to == Approx(1.399));
    std::string notes;
    for (const auto& note : result.notes) notes += note + "\n";
    CHECK(notes.find("sample rates differ") != std::string::npos);
    CHECK(notes.find("time ranges differ") != std::string::npos);
    for (double& t : simulated.time) t += 20;
    CHECK_THROWS_WITH(comparePlain(measured, simulated), Catch::Contains("s.csv: time: covers 20"));
}

TEST_CASE("a missing channel is named, and the mobile part alone is compared where nothing else is recorded") {
    const Recording measured = makeRecording(1e-3, 1, "m.csv");
    Recording simulated = measured;
    simulated.file = "s.csv";
    simulated.channels.erase(simulated.channels.begin() + 4, simulated.channels.begin() + 6);
    CHECK_THROWS_WITH(comparePlain(measured, simulated), Catch::Contains("s.csv: mobile.2.x: this channel"));
    Recording lone = measured;
    lone.channels.erase(lone.channels.begin() + 1);
    CHECK_THROWS_WITH(comparePlain(lone, measured), Catch::Contains("fixed.1.x: this channel is missing"));
    Recording mobile;
    mobile.file = "m.csv";
    mobile.time = measured.time;
    addChannel(mobile, "mobile.1.z", 1e-3, sweep);
    const RelativeDisplacement alone = calcRelativeDisplacement(mobile);
    CHECK(alone.q.row(0).maxCoeff() == Approx(1e-3).epsilon(1e-3));
    CHECK(alone.notes.back().find("mobile part alone") != std::string::npos);
}

TEST_CASE("accelerations alone are compared as displacements above 0.9 times the lowest excited frequency") {
    Recording measured;
    measured.file = "m.csv";
    for (int k = 0; k <= 8000; ++k) measured.time.push_back(1e-3 * k);
    const auto dwell = [](double t) { return std::sin(kPi * t / 8) * std::sin(kTwoPi * 10 * t); };
    Recording simulated = measured;
    addChannel(measured, "mobile.1.z", 1e-3, dwell);
    addChannel(simulated, "mobile.1.z", 0, dwell);
    simulated.channels[0].name = "mobile.1.az";
    for (std::size_t k = 0; k < measured.time.size(); ++k) {
        const double t = measured.time[k], slow = kPi / 8, fast = kTwoPi * 10;
        simulated.channels[0].values[k] =
            1e-3 * (-(slow * slow + fast * fast) * std::sin(slow * t) * std::sin(fast * t) +
                    2 * slow * fast * std::cos(slow * t) * std::cos(fast * t));
        measured.channels[0].values[k] += 5e-3;  // an offset that accelerations cannot see
    }
    addChannel(measured, "load.fz", 100, dwell);
    addChannel(simulated, "load.fz", 100, dwell);
    CHECK(comparePlain(measured, simulated).error < 0.02);
}

TEST_CASE("regimes are told by the stops of the model") {
    MountModel model = test::makeCross();
    model.connections[2].axis[2].stops = {{Side::negative, 1e-3, 8e5, 0.0}};
    model.connections[2].axis[2].offset = 2e-4;  // the stop is reached at −1.2 mm
    Eigen::MatrixXd q = Eigen::MatrixXd::Zero(12, 3);
    q(8, 0) = -1.1e-3;
    q(8, 1) = -1.3e-3;
    q(8, 2) = 5e-3;
    CHECK(findContact(q, model) == std::vector<bool>{false, true, false});
}
