#include <algorithm>
#include <catch2/catch.hpp>

#include "identify/motion/rigid_fit.hpp"
#include "models/bryant.hpp"
#include "models/common/error.hpp"
#include "tests/motion/analytic_motion.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

struct Case {
    unsigned seed = test::drawSeed();
    std::mt19937 random{seed};
    MountModel model = test::makeCrossModel();
    Recording recording = test::makeEmptyRecording(1000, 0.5);
};

void remove(Recording& recording, const std::vector<std::string>& names) {
    for (const std::string& name : names) {
        recording.channels.erase(std::remove_if(recording.channels.begin(), recording.channels.end(),
                                                [&](const Channel& channel) { return channel.name == name; }),
                                 recording.channels.end());
    }
}

/// Rotations of more than one radian; complete triads, a missing connection, single channels missing.
TEST_CASE("Exact rigid motions come back to round-off") {
    Case c;
    CAPTURE(c.seed);
    const test::AnalyticMotion motion(c.random, 0.02, 1.0, 5, 50);
    test::addChannels(c.recording, c.model, "mobile", motion, {"x", "y", "z", "ax", "ay", "az"}, {}, c.random);
    SECTION("all channels") {}
    SECTION("three of four connections") {
        remove(c.recording, {"mobile.2.x", "mobile.2.y", "mobile.2.z", "mobile.2.ax", "mobile.2.ay", "mobile.2.az"});
    }
    SECTION("eight of twelve channels") {
        remove(c.recording, {"mobile.1.y", "mobile.2.z", "mobile.3.x", "mobile.4.x"});
        remove(c.recording, {"mobile.1.ay", "mobile.2.az", "mobile.3.ax", "mobile.4.ax"});
    }
    const RigidFit displacement(collectChannels(c.recording, c.model, Part::mobile, Derivative::displacement), {});
    REQUIRE(displacement.undetermined().empty());
    Eigen::Matrix3Xd p, theta, a, alpha;
    Eigen::MatrixXd residuals;
    displacement.solvePoses(p, theta, &residuals);
    CHECK(residuals.cwiseAbs().maxCoeff() < 1e-13);
    Eigen::Matrix3Xd w(3, p.cols());
    for (Eigen::Index k = 0; k < p.cols(); ++k) {
        const double t = c.recording.time[k];
        w.col(k) = motion.w(t);
        REQUIRE((p.col(k) - motion.p(t)).norm() < 1e-13);
        REQUIRE((rotationFromVector(theta.col(k)) - motion.R(t)).norm() < 1e-11);
    }
    const RigidFit acceleration(collectChannels(c.recording, c.model, Part::mobile, Derivative::acceleration), {});
    acceleration.solveAccelerations(theta, w, a, alpha, &residuals);
    const double scale = alpha.cwiseAbs().maxCoeff();
    CHECK(residuals.cwiseAbs().maxCoeff() < 1e-10 * scale);
    for (Eigen::Index k = 0; k < p.cols(); ++k) {
        const double t = c.recording.time[k];
        REQUIRE((a.col(k) - motion.a(t)).norm() < 1e-10 * scale);
        REQUIRE((alpha.col(k) - motion.alpha(t)).norm() < 1e-9 * scale);
    }
}

TEST_CASE("Motions that the channels leave open are named") {
    Case c;
    const test::AnalyticMotion motion(c.random, 1e-3, 0.01, 5, 50);
    test::addChannels(c.recording, c.model, "mobile", motion, {"x", "y", "z"}, {}, c.random);
    const auto undetermined = [&] {
        return RigidFit(collectChannels(c.recording, c.model, Part::mobile, Derivative::displacement), {})
            .undetermined();
    };
    SECTION("markers on one line") {
        remove(c.recording, {"mobile.3.x", "mobile.3.y", "mobile.3.z", "mobile.4.x", "mobile.4.y", "mobile.4.z"});
        CHECK(undetermined() == std::vector<std::string>{"rotation about x"});
    }
    SECTION("axial channels only") {
        for (const char* i : {"1", "2", "3", "4"})
            remove(c.recording, {"mobile." + std::string(i) + ".x", "mobile." + std::string(i) + ".y"});
        CHECK(undetermined() == std::vector<std::string>{"translation x", "translation y", "rotation about z"});
    }
    SECTION("nothing along z") {
        for (const char* i : {"1", "2", "3", "4"}) remove(c.recording, {"mobile." + std::string(i) + ".z"});
        CHECK(undetermined() == std::vector<std::string>{"translation z", "rotation about x", "rotation about y"});
    }
}

/// Standard deviations promised are those that noise produces.
TEST_CASE("Noise passes into the six motions as predicted") {
    Case c;
    CAPTURE(c.seed);
    c.recording = test::makeEmptyRecording(1000, 8);
    const double sigma = 1e-6;
    const test::AnalyticMotion motion(c.random, 0, 0, 5, 50);
    test::addChannels(c.recording, c.model, "mobile", motion, {"x", "y", "z"}, {sigma, 0}, c.random);
    const RigidFit fit(collectChannels(c.recording, c.model, Part::mobile, Derivative::displacement), {});
    Eigen::Matrix3Xd p, theta;
    fit.solvePoses(p, theta, nullptr);
    const auto unit = fit.calcUnitDeviations();
    for (int i = 0; i < 3; ++i) {
        const auto n = static_cast<double>(p.cols());
        CHECK(p.row(i).norm() / std::sqrt(n) == Approx(sigma * unit[i]).epsilon(0.06));
        CHECK(theta.row(i).norm() / std::sqrt(n) == Approx(sigma * unit[3 + i]).epsilon(0.06));
    }
}

}  // namespace
}  // namespace wems::identify
