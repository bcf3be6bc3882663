// The rigid motion from sensors anywhere, turned, single axes among them: against the motion in closed form.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>

#include "identify/motion/motion.hpp"
#include "identify/motion/rigid_fit.hpp"
#include "models/bryant.hpp"
#include "models/common/error.hpp"
#include "tests/motion/analytic_motion.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

struct Laboratory {
    unsigned seed = test::drawSeed();
    std::mt19937 random{seed};
    MountModel model = test::makeCrossModel();
    Recording recording = test::makeEmptyRecording(1000, 4);
    test::AnalyticMotion motion{random, 2e-3, 0.02, 6, 40};

    Eigen::Vector3d randomVector(double size) {
        std::uniform_real_distribution<double> uniform(-size, size);
        return {uniform(random), uniform(random), uniform(random)};
    }

    /// A sensor at a random place, turned at random, with the axes named, `xz`.
    void addSensor(const std::string& name, bool accelerometer, const std::string& axes, double noise) {
        SensorPlace place;
        place.name = name;
        place.accelerometer = accelerometer;
        place.position = randomVector(0.3);
        place.rotation = randomVector(1.5);
        place.noise = noise;
        model.places.push_back(place);
        const Eigen::Matrix3d turned = rotationFromVector(place.rotation);
        std::normal_distribution<double> error(0, noise);
        for (const char axis : axes) {
            const Eigen::Vector3d direction = turned.col(axis - 'x');
            Channel channel{place.channelName(axis - 'x'), "", {}, 0};
            for (const double t : recording.time) {
                const Eigen::Matrix3d R = motion.R(t);
                const Eigen::Vector3d r = R * place.position;
                const Eigen::Vector3d w = motion.w(t);
                const double value =
                    accelerometer ? (R * direction).dot(motion.a(t) + motion.alpha(t).cross(r) + w.cross(w.cross(r)))
                                  : direction.dot(motion.p(t) + r - place.position);
                channel.values.push_back(value + (noise > 0 ? error(random) : 0));
            }
            recording.channels.push_back(std::move(channel));
        }
    }

    /// RMS errors of position (m) and rotation (rad), ends left out.
    std::pair<double, double> calcErrors(const RunMotion& run) const {
        double p = 0, theta = 0;
        const Eigen::Index n = run.mobile.p.cols(), margin = 300;
        for (Eigen::Index k = margin; k < n - margin; ++k) {
            const double t = run.time[k];
            p += (run.mobile.p.col(k) - motion.p(t)).squaredNorm();
            theta += (run.mobile.theta.col(k) - vectorFromRotation(motion.R(t))).squaredNorm();
        }
        const auto count = static_cast<double>(3 * (n - 2 * margin));
        return {std::sqrt(p / count), std::sqrt(theta / count)};
    }
};

}  // namespace

TEST_CASE("Markers anywhere, seen along any direction, give the exact motion") {
    Laboratory lab;
    CAPTURE(lab.seed);
    lab.addSensor("A", false, "xyz", 0);
    lab.addSensor("B", false, "xz", 0);
    lab.addSensor("C", false, "y", 0);
    lab.addSensor("D", false, "xyz", 0);
    const auto [p, theta] = lab.calcErrors(estimateMotion(lab.recording, lab.model));
    CHECK(p < 1e-9);
    CHECK(theta < 1e-8);
}

TEST_CASE("Turned accelerometers that ride on the part, single axes among them, beside markers") {
    Laboratory lab;
    CAPTURE(lab.seed);
    for (const char* name : {"A", "B", "C"}) lab.addSensor(name, false, "xyz", 0);
    for (const char* name : {"P", "Q", "R"}) lab.addSensor(name, true, "xyz", 0);
    lab.addSensor("S", true, "z", 0);
    lab.addSensor("T", true, "x", 0);
    const RunMotion run = estimateMotion(lab.recording, lab.model);
    CHECK(run.mobile.displacement_measured);
    CHECK(run.mobile.acceleration_measured);
    double error = 0, size = 0;
    for (Eigen::Index k = 300; k < run.mobile.a.cols() - 300; ++k) {
        const double t = run.time[k];
        error += (run.mobile.a.col(k) - lab.motion.a(t)).squaredNorm();
        size += lab.motion.a(t).squaredNorm();
    }
    CHECK(std::sqrt(error / size) < 1e-5);
}

TEST_CASE("Stated noise weighs the channels: the estimate is as good as that of the good ones") {
    Laboratory lab;
    CAPTURE(lab.seed);
    for (const char* name : {"A", "B", "C", "D"}) lab.addSensor(name, false, "xyz", 1e-6);
    const auto good = lab.calcErrors(estimateMotion(lab.recording, lab.model));
    for (const char* name : {"E", "F", "G"}) lab.addSensor(name, false, "xyz", 1e-4);
    const RunMotion weighted = estimateMotion(lab.recording, lab.model);
    const auto all = lab.calcErrors(weighted);
    CHECK(all.first < 1.1 * good.first);
    CHECK(all.second < 1.1 * good.second);
    CHECK(weighted.mobile.displacement_noise == Approx(1e-6).epsilon(0.1));
    for (SensorPlace& place : lab.model.places) place.noise = 0;
    CHECK(lab.calcErrors(estimateMotion(lab.recording, lab.model)).first > 3 * good.first);
}

TEST_CASE("What the sensors leave open is said") {
    Laboratory lab;
    CAPTURE(lab.seed);
    for (const char* name : {"A", "B"}) lab.addSensor(name, false, "z", 0);
    for (std::size_t i = 0; i < 2; ++i) lab.model.places[i].rotation.setZero();
    lab.model.places[0].position = {0.1, 0, 0};
    lab.model.places[1].position = {-0.1, 0, 0};
    const RigidFit fit(collectChannels(lab.recording, lab.model, Part::mobile, Derivative::displacement), {});
    CHECK(fit.undetermined() ==
          std::vector<std::string>{"translation x", "translation y", "rotation about x", "rotation about z"});
    CHECK_THROWS_WITH(estimateMotion(lab.recording, lab.model),
                      Catch::Contains("do not determine its translation x, translation y, rotation about x, rotation "
                                      "about z"));
}

}  // namespace wems::identify
