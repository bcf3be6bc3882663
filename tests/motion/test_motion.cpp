#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "identify/motion/motion.hpp"
#include "models/bryant.hpp"
#include "models/common/error.hpp"
#include "models/common/units.hpp"
#include "models/mount_model.hpp"
#include "tests/motion/analytic_motion.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

constexpr double sigma_x = 3e-6, sigma_a = 0.03;

struct Case {
    unsigned seed = test::drawSeed();
    std::mt19937 random{seed};
    MountModel model = test::makeCrossModel();
    Recording recording = test::makeEmptyRecording(1000, 6);
    test::AnalyticMotion motion;

    explicit Case(double amplitude = 2e-3, double angle = 0.02) : motion(random, amplitude, angle, 6, 40) {}
    void add(const std::vector<std::string>& quantities, test::SensorNoise noise = {}) {
        test::addChannels(recording, model, "mobile", motion, quantities, noise, random);
    }
};

struct Errors {
    double p = 0, v = 0, a = 0, theta = 0, w = 0, alpha = 0;  // RMS
};

/// RMS errors between samples `margin` and n − margin.
Errors calcErrors(const Case& c, const RunMotion& run, Eigen::Index margin) {
    Errors e;
    const Eigen::Index n = run.mobile.p.cols();
    for (Eigen::Index k = margin; k < n - margin; ++k) {
        const double t = run.time[k];
        e.p += (run.mobile.p.col(k) - c.motion.p(t)).squaredNorm();
        e.v += (run.mobile.v.col(k) - c.motion.v(t)).squaredNorm();
        e.a += (run.mobile.a.col(k) - c.motion.a(t)).squaredNorm();
        e.theta += (run.mobile.theta.col(k) - vectorFromRotation(c.motion.R(t))).squaredNorm();
        e.w += (run.mobile.w.col(k) - c.motion.w(t)).squaredNorm();
        e.alpha += (run.mobile.alpha.col(k) - c.motion.alpha(t)).squaredNorm();
    }
    for (double* sum : {&e.p, &e.v, &e.a, &e.theta, &e.w, &e.alpha})
        *sum = std::sqrt(*sum / static_cast<double>(3 * (n - 2 * margin)));
    return e;
}

bool hasNote(const RunMotion& run, const std::string& text) {
    return std::any_of(run.notes.begin(), run.notes.end(),
                       [&](const std::string& note) { return note.find(text) != std::string::npos; });
}

TEST_CASE("Large exact motions measured both ways come back") {
    Case c(0.02, 0.8);
    CAPTURE(c.seed);
    c.add({"x", "y", "z", "ax", "ay", "az"});
    const RunMotion run = estimateMotion(c.recording, c.model);
    const Errors e = calcErrors(c, run, 20);
    CHECK(e.p < 1e-6 * 0.02);
    CHECK(e.theta < 1e-5);
    CHECK(e.v < 1e-5);
    CHECK(e.w < 1e-3 * run.mobile.w.cwiseAbs().maxCoeff());
    CHECK(e.a < 1e-3 * run.mobile.a.cwiseAbs().maxCoeff());
    CHECK(e.alpha < 1e-3 * run.mobile.alpha.cwiseAbs().maxCoeff());
    CHECK(hasNote(run, "stands still"));
    CHECK(run.fixed.p.isZero());
}

TEST_CASE("Fusion of noisy measurements lowers noise without bias, and noise is estimated") {
    Case c;
    CAPTURE(c.seed);
    c.recording = test::makeEmptyRecording(1000, 12);
    c.add({"x", "y", "z", "ax", "ay", "az"}, {sigma_x, sigma_a});
    const RunMotion run = estimateMotion(c.recording, c.model);
    CHECK(run.mobile.displacement_noise == Approx(sigma_x).epsilon(0.04));
    CHECK(run.mobile.acceleration_noise == Approx(sigma_a).epsilon(0.04));
    const Errors e = calcErrors(c, run, 50);
    CHECK(e.p < 0.3 * sigma_x / 2);                   // raw: σ/2 with four markers
    CHECK(e.a == Approx(sigma_a / 2).epsilon(0.05));  // least squares sample by sample
    CHECK(e.v < 2e-4);                                // 0.03 m/s² / 2 integrated above 16 Hz
}

TEST_CASE("Displacements alone keep p and theta raw and derive the rest") {
    Case c;
    CAPTURE(c.seed);
    c.add({"x", "y", "z"}, {sigma_x, 0});
    const RunMotion run = estimateMotion(c.recording, c.model);
    CHECK(run.trusted_to >= 0.8 * c.motion.highestFrequency());  // the highest component may be a weak one
    CHECK(run.trusted_from == 0);
    CHECK_FALSE(run.mobile.acceleration_measured);
    CHECK(hasNote(run, "zero-phase derivatives"));
    CHECK_FALSE(hasNote(run, "too coarsely"));
    const Errors e = calcErrors(c, run, 100);
    CHECK(e.p == Approx(sigma_x / 2).epsilon(0.05));
    CHECK(e.v < 0.01 * run.mobile.v.cwiseAbs().maxCoeff());
    CHECK(e.w < 0.01 * run.mobile.w.cwiseAbs().maxCoeff());
    CHECK(e.a < 0.05 * run.mobile.a.cwiseAbs().maxCoeff());
}

TEST_CASE("Displacements with too few samples in a period: which rate would do") {
    const MountModel model = parseMountModel(
        "[body]\nmass = 1.0\ninertia = [0.01, 0.01, 0.01]\nmotion = [\"z\"]\n[[connection]]\nname = \"1\"\n"
        "position = [0.0, 0.0, 0.0]\n[connection.z]\nstiffness = 1.0e5\n",
        "one.toml");
    const double rate = GENERATE(400.0, 2000.0), f = 70;
    Recording recording = test::makeEmptyRecording(rate, 10);
    Channel mobile{"mobile.1.z", "m", {}, 2}, fixed{"fixed.1.z", "m", {}, 3};
    for (const double t : recording.time) {
        mobile.values.push_back(1e-3 * std::sin(kTwoPi * f * t));
        fixed.values.push_back(0);
    }
    recording.channels = {mobile, fixed};
    const RunMotion run = estimateMotion(recording, model);
    CAPTURE(rate, run.notes);
    // Eight samples in a period are the least that derivatives are trusted with.
    CHECK(hasNote(run, "too coarsely") == (rate < 8 * f));
    if (rate < 8 * f) CHECK(hasNote(run, "sample at 56"));
}

TEST_CASE("Accelerations alone give displacements above 0.6 of the lowest frequency") {
    Case c(2e-3, 0.02);
    CAPTURE(c.seed);
    c.recording = test::makeEmptyRecording(1000, 20);
    c.add({"ax", "ay", "az"}, {0, sigma_a});
    const RunMotion run = estimateMotion(c.recording, c.model);
    CHECK_FALSE(run.mobile.displacement_measured);
    CHECK(run.trusted_from == Approx(0.6 * c.motion.lowestFrequency()).epsilon(0.05));
    // The record starts and ends in full motion; away from the ends the high pass has forgotten that.
    const Errors e = calcErrors(c, run, 5000);
    CHECK(e.p < 0.01 * 2e-3);
    CHECK(e.theta < 0.01 * 0.02);
    CHECK(e.v < 0.01 * run.mobile.v.cwiseAbs().maxCoeff());
    CHECK(hasNote(run, "say nothing below"));
}

TEST_CASE("Velocities alone are used, beside displacements they are noted as unused") {
    Case c;
    CAPTURE(c.seed);
    c.recording = test::makeEmptyRecording(1000, 12);
    c.add({"vx", "vy", "vz"});
    SECTION("alone") {
        const RunMotion run = estimateMotion(c.recording, c.model);
        CHECK(hasNote(run, "velocity channels"));
        CHECK(calcErrors(c, run, 3000).v < 0.01 * run.mobile.v.cwiseAbs().maxCoeff());
    }
    SECTION("beside displacements") {
        c.add({"x", "y", "z"});
        CHECK(hasNote(estimateMotion(c.recording, c.model), "not used"));
    }
}

TEST_CASE("Stamps are taken for what they are") {
    Case c;
    CAPTURE(c.seed);
    std::uniform_real_distribution<double> jitter(-2e-4, 2e-4);
    SECTION("samples at irregular instants are interpolated") {
        for (double& t : c.recording.time) t += jitter(c.random);
        c.add({"x", "y", "z"});
        const RunMotion run = estimateMotion(c.recording, c.model);
        CHECK(hasNote(run, "not uniform"));
        CHECK(calcErrors(c, run, 100).p < 1e-7);
    }
    SECTION("stamps that jitter alone are not, with noise or without") {
        c.add({"x", "y", "z"});
        const double noise = GENERATE(0.0, 1e-6);
        std::normal_distribution<double> normal;
        for (Channel& channel : c.recording.channels)
            for (double& value : channel.values) value += noise * normal(c.random);
        for (double& t : c.recording.time) t += jitter(c.random);
        const RunMotion run = estimateMotion(c.recording, c.model);
        CHECK(hasNote(run, "time stamps jitter by"));
        // The clock itself is known to the jitter over the root of the number of samples.
        CHECK(calcErrors(c, run, 100).p < 4e-6);
    }
    SECTION("a clock that drifts is interpolated") {
        const double length = c.recording.time.back();
        for (double& t : c.recording.time) t += 2e-3 * std::sin(3 * t / length) + 1e-2 * jitter(c.random);
        c.add({"x", "y", "z"});
        CHECK(hasNote(estimateMotion(c.recording, c.model), "not uniform"));
    }
    SECTION("rounded to 0.1 ms at 3 kHz, whenever it begins") {
        c.recording = test::makeEmptyRecording(3000, 2);
        c.add({"x", "y", "z"});
        const double start = GENERATE(0.0, 500.0, -20.0);
        CAPTURE(start);
        for (double& t : c.recording.time) t = start + std::round(t * 1e4) / 1e4;
        const RunMotion run = estimateMotion(c.recording, c.model);
        CHECK(hasNote(run, "decimals"));
        CHECK(run.time[1001] == Approx(start + 1001 / 3000.0).epsilon(1e-9));
    }
    SECTION("uniform, whenever it begins") {
        c.add({"x", "y", "z"});
        for (double& t : c.recording.time) t += 500;
        const RunMotion run = estimateMotion(c.recording, c.model);
        CHECK_FALSE(hasNote(run, "uniform"));
        CHECK(run.time == c.recording.time);
    }
}

TEST_CASE("What cannot be recovered is an error that names it") {
    Case c;
    c.add({"x", "y", "z"});
    SECTION("markers on one line") {
        c.recording.channels.resize(6);
        CHECK_THROWS_WITH(estimateMotion(c.recording, c.model), Catch::Contains("rotation about x"));
    }
    SECTION("no channel of the mobile part") {
        for (Channel& channel : c.recording.channels) channel.name.replace(0, 6, "fixed");
        CHECK_THROWS_AS(estimateMotion(c.recording, c.model), InputError);
    }
    SECTION("a bracket, but no channel of the fixed part") {
        BracketMode mode;
        mode.frequency = 60;
        mode.translation = {0, 0, 0.3};
        c.model.bracket.push_back(mode);
        CHECK_THROWS_WITH(estimateMotion(c.recording, c.model), Catch::Contains("fixed"));
    }
    SECTION("a connection that the model does not have") {
        c.recording.channels[0].name = "mobile.9.x";
        CHECK_THROWS_AS(estimateMotion(c.recording, c.model), InputError);
    }
}

/// Displacements count from the equilibrium: under gravity the rest pose is added.
TEST_CASE("Gravity shifts the pose by the static deflection") {
    Case c;
    CAPTURE(c.seed);
    c.model.gravity = {0, 0, -9.81};
    c.add({"x", "y", "z"});
    const RunMotion run = estimateMotion(c.recording, c.model);
    const double sag = -8 * 9.81 / 4e5;
    for (const Eigen::Index k : {0, 700, 4000}) {
        const double t = run.time[k];
        CHECK(run.mobile.p(2, k) == Approx(c.motion.p(t).z() + sag).margin(1e-9));
    }
}

TEST_CASE("Without channels of its own the fixed part follows the base") {
    Case c;
    CAPTURE(c.seed);
    c.recording = test::makeEmptyRecording(1000, 12);
    c.add({"x", "y", "z"});
    Channel base;
    base.name = "base.az";
    const double w = 2 * 3.14159265358979323846 * 10;
    for (const double t : c.recording.time) base.values.push_back(2 * std::sin(w * t));
    c.recording.channels.push_back(base);
    const RunMotion run = estimateMotion(c.recording, c.model);
    for (const Eigen::Index k : {5000, 6010, 7025}) {
        const double t = run.time[k];
        CHECK(run.fixed.p(2, k) == Approx(-2 / (w * w) * std::sin(w * t)).margin(0.01 * 2 / (w * w)));
        CHECK(run.fixed.v(2, k) == Approx(-2 / w * std::cos(w * t)).margin(0.01 * 2 / w));
    }
    CHECK(hasNote(run, "follows the base"));
}

}  // namespace
}  // namespace wems::identify
