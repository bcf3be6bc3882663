// Motion between the samples of a contact and beyond the low pass, against a fine integration of the same device.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/motion/motion.hpp"
#include "identify/problem/fast_motion.hpp"
#include "identify/problem/run_filter.hpp"
#include "models/common/units.hpp"
#include "models/parameter_access.hpp"
#include "tests/fit/synthetic_run.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

constexpr ExcitedBand kBand{5, 50, 13, 0};

OpenLoopRun openLoop(const test::SyntheticRun& run, const MountModel& model, const ExcitedBand& band) {
    return makeOpenLoopRun(estimateMotion(test::record(run, {0, -1}, 1), model), model, band, {});
}

/// RMS of a difference where the taper counts.
double calcError(const OpenLoopRun& run, const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    const Eigen::Index count = std::min(a.cols(), b.cols());
    return std::sqrt(((a.leftCols(count) - b.leftCols(count)) * run.taper.head(count).asDiagonal()).squaredNorm() /
                     static_cast<double>(a.rows() * count));
}

}  // namespace

// A mass on two springs that a guide lets move along z alone: f = sqrt((k + k_stop) / m) / 2 pi.
TEST_CASE("The frequency of contact is that of the mass on its stiffest stops", "[fast motion]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> draw(0.5, 2);
    MountModel model;
    model.body.mass = 8 * draw(random);
    model.body.inertia = Eigen::Vector3d(0.1, 0.1, 0.05).asDiagonal();
    model.body.free = {false, false, true, false, false, false};
    double sum = 0;
    for (const double x : {-0.1, 0.1}) {
        Connection connection;
        connection.name = x < 0 ? "1" : "2";
        connection.position = {x, 0, 0};
        const double k = 1e5 * draw(random), stop = 1e6 * draw(random);
        connection.axis[2].stiffness = k;
        connection.axis[2].stops = {{Side::positive, 1e-3, 0.5 * stop, 0}, {Side::negative, 1e-3, stop, 0}};
        sum += k + stop;
        model.connections.push_back(connection);
    }
    CHECK(calcContactFrequency(model) == Approx(std::sqrt(sum / model.body.mass) / kTwoPi));
    for (Connection& connection : model.connections) connection.axis[2].stops.clear();
    CHECK(calcContactFrequency(model) == 0);
}

// Between samples a sine is what it is, with both derivatives; what is left of it is what calcResponse() says.
TEST_CASE("A filter keeps sines between samples, and knows what it leaves of them", "[fast motion]") {
    constexpr double interval = 2e-3;
    constexpr int samples = 2000;
    const RunFilter filter(interval, {5, 50, 13, 134});
    REQUIRE(filter.refines());
    const Eigen::RowVectorXd time = Eigen::RowVectorXd::LinSpaced(samples, 0, (samples - 1) * interval);
    for (const double frequency : {5.0, 50.0, 110.0, 160.0, 190.0, 220.0}) {
        CAPTURE(frequency);
        const double w = kTwoPi * frequency, left = filter.calcResponse(frequency);
        if (frequency < filter.pass()) CHECK(left == Approx(1).margin(1e-3));
        const Eigen::RowVectorXd sine = (w * time.array()).sin();
        const Eigen::MatrixXd value = filter.apply(sine, 0), rate = filter.apply(sine, 1),
                              second = filter.apply(sine, 2);
        double error[3] = {};
        const Eigen::Index edge = 400;
        for (Eigen::Index k = edge; k < value.cols() - edge; ++k) {
            const double t = filter.interval() * static_cast<double>(k);
            error[0] = std::max(error[0], std::abs(value(0, k) - left * std::sin(w * t)));
            error[1] = std::max(error[1], std::abs(rate(0, k) / w - left * std::cos(w * t)));
            error[2] = std::max(error[2], std::abs(second(0, k) / (w * w) + left * std::sin(w * t)));
        }
        // What the window leaves of the images of a sine, as of its derivatives in a plain run.
        for (const double e : error) CHECK(e < 1e-3);
    }
}

// 500 samples a second of a device that hits its stops: the relative motion against that of four times as many.
TEST_CASE("Fast motion of contacts comes back from coarse displacements", "[fast motion]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    const MountModel device =
        test::perturb(readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml"), 0.1, seed);
    test::SweepSettings sweep;
    sweep.force = {0, 0, 500};
    sweep.octaves_per_minute = 60;
    sweep.sample_rate = 500;
    sweep.steps_per_sample = 32;
    const test::SyntheticRun coarse = test::simulateSweep(device, sweep);
    ExcitedBand band = kBand;
    band.contact = calcContactFrequency(device);
    const OpenLoopRun plain = openLoop(coarse, device, band);
    REQUIRE(plain.filter.refines());
    REQUIRE(reachesStops(plain, device));
    const OpenLoopRun restored = restoreFastMotion(plain, device);

    const auto factor = static_cast<int>(std::lround(plain.raw_interval / plain.interval));
    sweep.sample_rate *= factor;
    sweep.steps_per_sample = 32 / factor;
    REQUIRE(32 % factor == 0);
    const test::SyntheticRun fine = test::simulateSweep(device, sweep);
    const Eigen::Index count = std::min<Eigen::Index>(plain.sampleCount(), fine.p_M.cols());
    SmoothPart mobile, fixed;
    mobile.p = fine.p_M.leftCols(count);
    mobile.v = fine.v_M.leftCols(count);
    mobile.w = fine.w_M.leftCols(count);
    mobile.R.assign(fine.R_GM.begin(), fine.R_GM.begin() + count);
    fixed.p = fine.p_F.leftCols(count);
    fixed.v = fine.v_F.leftCols(count);
    fixed.w = fine.w_F.leftCols(count);
    fixed.R.assign(fine.R_GF.begin(), fine.R_GF.begin() + count);
    AxisSeries q, v;
    calcRelative(device, mobile, fixed, q, v);

    const double before = calcError(plain, plain.q, q), after = calcError(plain, restored.q, q);
    INFO("relative displacement errs by " << before << " m before and " << after << " m after");
    CHECK(after < 0.1 * before);
    CHECK(calcError(plain, restored.v, v) < 0.2 * calcError(plain, plain.v, v));
}
