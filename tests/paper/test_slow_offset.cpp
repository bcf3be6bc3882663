// The slow motion that accelerations do not show, from the balance of the mount's force.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/fit/fit.hpp"
#include "identify/fit/slow_offset.hpp"
#include "identify/forward/relative_displacement.hpp"
#include "identify/motion/spectrum.hpp"
#include "models/parameter_access.hpp"
#include "tests/fit/synthetic_run.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

/// RMS over all connections and axes of the relative displacement below `below` (Hz) minus the exact one.
double calcSlowError(const RunMotion& motion, const MountModel& model, const test::SyntheticRun& truth, double below) {
    const RelativeDisplacement estimate = calcRelativeDisplacement(motion, model);
    double squares = 0;
    for (std::size_t i = 0; i < model.connections.size(); ++i) {
        const Eigen::Vector3d& r = model.connections[i].position;
        Eigen::Matrix3Xd exact(3, estimate.q.cols());
        for (Eigen::Index k = 0; k < exact.cols(); ++k) {
            const std::size_t n = k;
            exact.col(k) = truth.R_GF[n].transpose() *
                           (truth.p_M.col(k) + truth.R_GM[n] * r - truth.p_F.col(k) - truth.R_GF[n] * r);
        }
        for (Eigen::Index axis = 0; axis < 3; ++axis) {
            const Eigen::VectorXd error = (estimate.q.row(3 * i + axis) - exact.row(axis)).transpose();
            squares += keepSlowPart(error, truth.interval, below, 1.2 * below).x.squaredNorm() /
                       static_cast<double>(error.size());
        }
    }
    return std::sqrt(squares / static_cast<double>(3 * model.connections.size()));
}

MountModel makeAsymmetricDevice() {
    MountModel device = readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
    for (Connection& connection : device.connections)
        for (Stop& stop : connection.axis[2].stops) stop.clearance = stop.side == Side::positive ? 0.9e-3 : 1.3e-3;
    return device;
}

test::SyntheticRun simulateShortSweep(const MountModel& device) {
    test::SweepSettings settings;
    settings.force = {0, 0, 400};
    settings.from = 8;
    settings.to = 15;
    settings.octaves_per_minute = 30;
    settings.sample_rate = 4000;
    settings.steps_per_sample = 2;
    return test::simulateSweep(device, settings);
}

TEST_CASE("With the true law the shift of the mean position comes back from accelerations alone") {
    const MountModel device = makeAsymmetricDevice();
    const test::SyntheticRun run = simulateShortSweep(device);
    RunMotion motion = estimateMotion(test::record(run, {-1, 0}, 1), device);
    REQUIRE(lacksSlowMotion(motion));
    const auto recorded = motion.time.size();
    cutRinging(motion);
    CHECK(motion.time.size() < recorded);
    CHECK(motion.time.size() > recorded / 2);
    const double below = 0.6 * motion.trusted_from;
    const double before = calcSlowError(motion, device, run, below);
    for (int pass = 0; pass < 8; ++pass) updateSlowOffset(motion, device);
    const double after = calcSlowError(motion, device, run, below);
    CAPTURE(before, after);
    CHECK(before > 1e-6);
    CHECK(after < 0.1 * before);
}

TEST_CASE("Unequal clearances come out of accelerations alone within 2 %") {
    const MountModel device = makeAsymmetricDevice();
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    const MountModel believed = test::perturb(device, 0.25, seed);
    const Recording recording = test::record(simulateShortSweep(device), {-1, 0.01}, seed);
    const FitResult fit = fitMount({estimateMotion(recording, believed)}, believed);
    int clearances = 0;
    for (const FittedParameter& parameter : fit.parameters) {
        const bool often_hit = parameter.name.find("3.z.") == 0 || parameter.name.find("4.z.") == 0;
        if (!often_hit || parameter.name.find("clearance") == std::string::npos) continue;
        CAPTURE(parameter.name);
        CHECK(parameter.value == Approx(getParameter(device, parameter.name)).epsilon(0.02));
        ++clearances;
    }
    CHECK(clearances == 4);
}

TEST_CASE("Runs with displacements keep theirs") {
    const MountModel device = readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
    test::SweepSettings settings;
    settings.force = {0, 0, 50};
    settings.octaves_per_minute = 120;
    CHECK_FALSE(
        lacksSlowMotion(estimateMotion(test::record(test::simulateSweep(device, settings), {0, 0}, 1), device)));
}

TEST_CASE("The slow part of a sum of sines is the slow sine, and its rate the derivative") {
    constexpr double interval = 1e-3, pi = 3.141592653589793;
    Eigen::VectorXd signal(20000), slow(20000), rate(20000);
    for (Eigen::Index k = 0; k < signal.size(); ++k) {
        const double t = interval * static_cast<double>(k);
        const double envelope = std::pow(std::sin(pi * t / 20), 2);  // begins and ends at rest
        slow(k) = envelope * std::sin(2 * pi * t);
        rate(k) = envelope * 2 * pi * std::cos(2 * pi * t) + pi / 20 * std::sin(2 * pi * t / 20) * std::sin(2 * pi * t);
        signal(k) = slow(k) + envelope * std::sin(2 * pi * 8 * t);
    }
    const SlowSignal part = keepSlowPart(signal, interval, 3, 4.5);
    CHECK((part.x - slow).cwiseAbs().maxCoeff() < 1e-3);
    CHECK((part.rate - rate).cwiseAbs().maxCoeff() < 1e-2);
}

}  // namespace
}  // namespace wems::identify
