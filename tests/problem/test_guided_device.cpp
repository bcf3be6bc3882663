#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <string>

#include "identify/problem/load_wrench.hpp"
#include "identify/problem/mount_equation.hpp"
#include "identify/updating/test_problem.hpp"
#include "models/pi.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;
using namespace wems::identify::updating;

namespace {

/// A mass that a guide lets move along z alone, on two mounts beside each other, loaded by a shaker.
MountModel makeGuidedDevice() {
    MountModel model;
    model.body.mass = 0.6;
    model.body.inertia = Eigen::Vector3d(0.005, 0.005, 0.005).asDiagonal();
    model.body.free = {false, false, true, false, false, false};
    for (const double x : {-0.1, 0.1}) {
        Connection connection;
        connection.name = std::to_string(model.connections.size() + 1);
        connection.position = {x, 0, 0};
        connection.axis[2].stiffness = 7e4;
        connection.axis[2].damping = 15;
        model.connections.push_back(connection);
    }
    model.load_point = LoadPoint{Part::mobile, Eigen::Vector3d::Zero()};
    return model;
}

/// One displacement sensor along z(t) = X sin φ(t), φ a sweep from 20 to 200 Hz, and the load m z'' + c z' + k z: in
/// closed form, so that no simulation is needed.
Recording makeSweep(const MountModel& model, double noise, std::mt19937_64& random) {
    constexpr double kDuration = 10, kRate = 4000, kFrom = 20, kTo = 200, kAmplitude = 1e-4, kForceNoise = 1e-3;
    double k = 0, c = 0;
    for (const Connection& connection : model.connections) {
        k += connection.axis[2].stiffness;
        c += connection.axis[2].damping;
    }
    std::normal_distribution<double> normal;
    Recording recording;
    recording.file = "guided.csv";
    Channel z{"mobile.1.z", "m", {}}, load{"load.fz", "N", {}};
    const double rate = (kTo - kFrom) / kDuration;
    for (int i = 0; i <= static_cast<int>(kDuration * kRate); ++i) {
        const double t = i / kRate;
        const double phase = kTwoPi * (kFrom * t + 0.5 * rate * t * t), w = kTwoPi * (kFrom + rate * t);
        const double v = kAmplitude * w * std::cos(phase);
        const double a = kAmplitude * (kTwoPi * rate * std::cos(phase) - w * w * std::sin(phase));
        recording.time.push_back(t);
        z.values.push_back(kAmplitude * std::sin(phase) + noise * normal(random));
        load.values.push_back(model.body.mass * a + c * v + k * kAmplitude * std::sin(phase) +
                              kForceNoise * normal(random));
    }
    recording.channels = {z, load};
    return recording;
}

double calcMountMisfit(const Recording& recording, const MountModel& model) {
    const TestProblem problem({recording}, {}, model);
    const auto block = static_cast<std::size_t>(Block::mount);
    const BlockInformation mount = problem.misfit(problem.believedPoint()).identification[block];
    return mount.chi_squared / mount.count;
}

}  // namespace

TEST_CASE("A load on the mobile part at rest is what the mount must bear, with its moment") {
    MountModel model = makeGuidedDevice();
    model.load_point->position = {0.1, -0.2, 0.3};
    OpenLoopRun run;
    constexpr int samples = 5;
    run.interval = run.raw_interval = 1e-3;
    run.time = Eigen::VectorXd::LinSpaced(samples, 0, (samples - 1) * run.interval);
    run.q = run.v = run.quiet_v = Eigen::MatrixXd::Zero(6, samples);
    for (SmoothPart* part : {&run.mobile, &run.fixed}) {
        part->p = part->theta = part->v = part->w = part->a = part->alpha = Eigen::Matrix3Xd::Zero(3, samples);
        part->R.assign(samples, Eigen::Matrix3d::Identity());
    }
    run.load = Eigen::Vector3d(1, 2, 3).replicate(1, samples);
    Eigen::Matrix<double, 6, 1> expected;
    expected << -1, -2, -3, 1.2, 0, -0.4;  // −(F ; p × F)
    CHECK((calcMountResidual(run, model).colwise() - expected).norm() < 1e-12);
    MountModel doubled = model;
    doubled.load.emplace();
    doubled.load->gain_over_frequency = {{0, 2}};
    CHECK((calcMountDifference(run, model, doubled).colwise() - expected).norm() < 1e-12);
}

// Without redundancy the noise is told from the channel itself, in the quarter of the time in which a band is quiet: to
// a factor of 1.5 or so. Two percent of a stiffness move a force of 14 N by 0.14 N, a hundred times the noise.
TEST_CASE("A guided device, loaded itself, leaves nothing but noise at the truth") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel model = makeGuidedDevice();
    const Recording recording = makeSweep(model, 1e-7, random);
    const double exact = calcMountMisfit(recording, model);
    CHECK(exact > 0.5);
    CHECK(exact < 1.5);
    MountModel wrong = model;
    wrong.connections[0].axis[2].stiffness *= 1.02;
    CHECK(calcMountMisfit(recording, wrong) > 10 * exact);
}
