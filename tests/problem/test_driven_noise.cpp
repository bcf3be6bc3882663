#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <string>

#include "identify/verdict/driven_noise.hpp"
#include "identify/verdict/free_error.hpp"
#include "models/common/units.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

constexpr int kSamples = 40000;
constexpr double kRate = 2000, kMass = 0.6, kStiffness = 1.4e5, kDamping = 30;

/// A mass that a guide lets move along z alone, on two mounts beside each other.
MountModel makeLinearDevice() {
    MountModel model;
    model.body.mass = kMass;
    model.body.inertia = Eigen::Vector3d(0.005, 0.005, 0.005).asDiagonal();
    model.body.free = {false, false, true, false, false, false};
    for (const double x : {-0.1, 0.1}) {
        Connection connection;
        connection.name = std::to_string(model.connections.size() + 1);
        connection.position = {x, 0, 0};
        connection.axis[2].stiffness = kStiffness / 2;
        connection.axis[2].damping = kDamping / 2;
        model.connections.push_back(connection);
    }
    return model;
}

RunMotion makeStillMotion() {
    RunMotion run;
    run.interval = 1 / kRate;
    for (int i = 0; i < kSamples; ++i) run.time.push_back(i / kRate);
    for (PartMotion* part : {&run.mobile, &run.fixed})
        for (Eigen::Matrix3Xd* rows : {&part->p, &part->theta, &part->v, &part->w, &part->a, &part->alpha})
            rows->setZero(3, kSamples);
    run.mobile.displacement_measured = true;
    run.trusted_to = 0.25 * kRate;
    return run;
}

FreeRun makeFreeRun(const RunMotion& motion, double lowest, double highest) {
    FreeRun run{&motion, Eigen::MatrixXd::Zero(6, kSamples)};
    run.drive.lowest = lowest;
    run.drive.highest = highest;
    return run;
}

/// Of a function of frequency over the band that noise is drawn in.
template <class Function>
double integrate(const DriveNoise& noise, const Function& density) {
    const double from = 0.5 * noise.lowest, to = 2 * noise.highest, step = (to - from) / 200000;
    double sum = 0;
    for (double f = from + step / 2; f < to; f += step) sum += step * density(f);
    return sum;
}

const double kResonance = std::sqrt(kStiffness / kMass) / kTwoPi;

}  // namespace

// Of a linear device the mean square is the integral of the load's density times the squared receptance.
TEST_CASE("What the noise of a load makes of a linear device is its receptance") {
    const MountModel model = [] {
        MountModel loaded = makeLinearDevice();
        loaded.load_point = LoadPoint{Part::mobile, Eigen::Vector3d::Zero()};
        return loaded;
    }();
    RunMotion motion = makeStillMotion();
    motion.fixed_source = FixedSource::still;
    motion.load.setZero(3, kSamples);
    FreeRun run = makeFreeRun(motion, 0.2 * kResonance, 3 * kResonance);
    constexpr double kVariance = 0.04;
    run.drive.load = NoiseDensity(kVariance);
    const double expected = integrate(run.drive, [](double f) {
        const double w = kTwoPi * f;
        return 2 / kRate * kVariance / std::norm(std::complex<double>(kStiffness - kMass * w * w, kDamping * w));
    });
    const DrivenNoise driven = calcDrivenNoise(run, model, 7);
    // Along z alone, one of three rows of each connection. Twenty seconds begin at rest and hold some 15 % of chance.
    CHECK(3 * driven.square == Approx(expected).epsilon(0.3));
    CHECK(driven.deviation > 0);
    CHECK(driven.deviation < driven.square);
}

// Far below its resonance a device follows its base: what is left is the noise of the displacement that is integrated
// from the accelerometer, against which the device is measured. 1/f noise in place of white.
TEST_CASE("The noise of a base's accelerometer is in what a simulation is compared with") {
    RunMotion motion = makeStillMotion();
    motion.fixed_source = FixedSource::base;
    motion.fixed.acceleration_measured = true;
    motion.fixed.acceleration_noise = std::nan("");
    motion.base.setZero(3, kSamples);
    FreeRun run = makeFreeRun(motion, 0.02 * kResonance, 0.05 * kResonance);
    constexpr double kPink = 1e-3;  // (m/s²)² Hz
    std::vector<double> variances;
    for (int k = 0; k <= 4000; ++k) variances.push_back(kPink / (0.25 * std::max(1, k)));
    run.drive.base = run.drive.acceleration = NoiseDensity(0.25, variances);
    const double expected =
        integrate(run.drive, [](double f) { return 2 / kRate * kPink / f / std::pow(kTwoPi * f, 4); });
    CHECK(calcDrivenNoise(run, makeLinearDevice(), 7).square == Approx(expected).epsilon(0.3));
    // A motion that is measured by displacements has their noise, which counts elsewhere.
    motion.fixed.displacement_measured = true;
    CHECK(calcDrivenNoise(run, makeLinearDevice(), 7).square < 0.1 * expected);
}

TEST_CASE("What a cause is worth is judged by what the drive's noise leaves") {
    const FreeError before{0.05, 0, false, {}}, after{0.049, 0, false, {}};
    CHECK_FALSE(isImproved(before, after));
    CHECK(isWorthless(after, before));
    // All but 1 % of the motion is noise, known to a tenth of that: errors add as squares.
    const DrivenNoise noise{0.05 * 0.05 - 0.01 * 0.01, 1e-5};
    CHECK(isImproved({0.05, 0, false, noise}, {0.049, 0, false, noise}));
    CHECK_FALSE(isWorthless({0.049, 0, false, noise}, {0.05, 0, false, noise}));
    // What the noise's own scatter could be is no gain.
    const DrivenNoise vague{0.06 * 0.06, 2e-3};
    CHECK_FALSE(isImproved({0.05, 0, false, vague}, {0.049, 0, false, vague}));
    const FreeError lost{std::numeric_limits<double>::infinity(), 0, true, {}};
    CHECK(isImproved(lost, after));
    CHECK_FALSE(isImproved(before, lost));
    CHECK_FALSE(isWorthless(after, lost));
    CHECK(isWorthless(lost, after));
}

// What is as good as asked for decides nothing: 3 % of the motion, or one and a half noise floors.
TEST_CASE("A prediction is spoilt where it is worse and not as good as asked for") {
    const FreeError good{0.02, 0.01, false, {}}, fair{0.04, 0.01, false, {}}, noisy{0.07, 0.05, false, {}};
    CHECK_FALSE(isSpoilt(good, {0.029, 0.01, false, {}}));
    CHECK(isSpoilt(good, fair));
    CHECK_FALSE(isSpoilt(fair, {0.0415, 0.01, false, {}}));
    CHECK(isSpoilt(fair, {0.0425, 0.01, false, {}}));
    CHECK_FALSE(isSpoilt({0.06, 0.05, false, {}}, noisy));
    const FreeError lost{std::numeric_limits<double>::infinity(), 0, true, {}};
    CHECK(isSpoilt(good, lost));
    CHECK_FALSE(isSpoilt(lost, fair));
    CHECK_FALSE(isSpoilt(lost, lost));
}
