// What drives a run: interpolation between samples, swept frequency, load correction.
#include <catch2/catch.hpp>
#include <cmath>

#include "models/common/error.hpp"
#include "models/common/units.hpp"
#include "models/excitation.hpp"
#include "tests/forward/forward_fixture.hpp"

using namespace wems;
using namespace wems::identify;

TEST_CASE("the load between samples is met to fourth order") {
    const auto measure = [](double interval) {
        TimeGrid coarse = test::makeGrid(interval, static_cast<int>(std::lround(0.2 / interval)) + 1);
        TimeGrid fine = coarse;
        fine.steps_per_sample = 4;
        Eigen::Matrix3Xd load = Eigen::Matrix3Xd::Zero(3, coarse.samples);
        for (int k = 0; k < coarse.samples; ++k) load(1, k) = std::sin(kTwoPi * 50 * coarse.sampleTime(k));
        const Drive drive = Drive::makeLoad(test::makeTimes(coarse), load, {}, fine);
        double worst = 0;  // two intervals at each end have lower order
        for (int half = 16; half < fine.halfSteps() - 16; ++half)
            worst = std::max(worst, std::abs(drive.load()(1, half) - std::sin(kTwoPi * 50 * fine.halfStepTime(half))));
        return worst;
    };
    CHECK(measure(1e-3) < 5e-5);
    CHECK(std::log2(measure(1e-3) / measure(5e-4)) == Approx(4).margin(0.3));
}

TEST_CASE("a load with few samples in a period is met by a windowed sinc, its shift at all rows") {
    TimeGrid grid = test::makeGrid(1e-3, 2001);
    TimeGrid fine = grid;
    fine.steps_per_sample = 3;
    const auto at = [](double t) {
        double sum = 0;
        for (const double f : {37.3, 170.9, 263.1, 349.7}) sum += std::sin(kTwoPi * f * t + f);
        return sum;
    };
    Eigen::Matrix3Xd load = Eigen::Matrix3Xd::Zero(3, grid.samples);
    for (int k = 0; k < grid.samples; ++k) load(2, k) = at(grid.sampleTime(k));
    const Drive drive = Drive::makeLoad(test::makeTimes(grid), load, {}, fine);
    double worst = 0;  // where the sinc has samples on both sides
    for (int half = 300; half < fine.halfSteps() - 300; ++half)
        worst = std::max(worst, std::abs(drive.load()(2, half) - at(fine.halfStepTime(half))));
    CHECK(worst < 4e-3);  // of four ones; cubics leave (2 pi 0.35)^4 / 384 of the last, 6 %
    CHECK(drive.load().topRows(2).isZero(0));

    const Drive shifted = drive.withLoadShift({0, 0, 0.5});
    const MountModel model = test::makeCross();
    const Eigen::MatrixXd expected =
        ForwardModel(model)
            .simulate(Drive::makeLoad(test::makeTimes(grid), load.colwise() + Eigen::Vector3d(0, 0, 0.5), {}, fine))
            .q;
    CHECK(test::calcRelativeError(ForwardModel(model).simulate(shifted).q, expected) < 1e-9);
    CHECK_THROWS_AS(Drive::makeFree(grid).withLoadShift({0, 0, 1}), std::logic_error);
}

TEST_CASE("outside of the recorded time there is no load, and no motion to follow") {
    const TimeGrid recorded = test::makeGrid(1e-3, 11);
    TimeGrid longer = test::makeGrid(1e-3, 21);
    const Eigen::Matrix3Xd load = Eigen::Matrix3Xd::Ones(3, 11);
    const Drive drive = Drive::makeLoad(test::makeTimes(recorded), load, {}, longer);
    CHECK(drive.load()(0, longer.halfStepOf(10)) == Approx(1));
    CHECK(drive.load()(0, longer.halfStepOf(11)) == 0);
    PartMotion still;
    for (auto* matrix : {&still.p, &still.theta, &still.v, &still.w}) *matrix = Eigen::Matrix3Xd::Zero(3, 11);
    CHECK_THROWS_AS(Drive::makeFixedMotion(test::makeTimes(recorded), still, longer), std::invalid_argument);
}

TEST_CASE("the load correction acts on the recorded load") {
    MountModel model = test::makeCross();
    model.bracket = test::makeBracketModes();
    const TimeGrid grid = test::makeGrid(1e-3, 1001, 2);
    const std::vector<double> times = test::makeTimes(grid);
    const auto sweep = makeLinearSweep(10, 40, 30);
    Eigen::Matrix3Xd load = Eigen::Matrix3Xd::Zero(3, grid.samples);
    for (int k = 0; k < grid.samples; ++k) load(2, k) = 10 * sweep->value(grid.sampleTime(k));
    const Drive drive = Drive::makeLoad(times, load, {}, grid);

    MountModel corrected = model;
    corrected.load = LoadCorrection{{{0.0, 0.7}}};
    const Eigen::MatrixXd by_gain = ForwardModel(corrected).simulate(drive).q;
    CHECK(test::calcRelativeError(
              by_gain, ForwardModel(model).simulate(Drive::makeLoad(times, 0.7 * load, {}, grid)).q) < 1e-10);

    // Each axis by its own.
    Eigen::Matrix3Xd everywhere = Eigen::Vector3d(1, -2, 1.5) * load.row(2), scaled = everywhere;
    corrected.load->axis_gain = {1.1, 0.8, 0.95};
    for (int a = 0; a < 3; ++a) scaled.row(a) *= 0.7 * corrected.load->axis_gain[a];
    CHECK(test::calcRelativeError(ForwardModel(corrected).simulate(Drive::makeLoad(times, everywhere, {}, grid)).q,
                                  ForwardModel(model).simulate(Drive::makeLoad(times, scaled, {}, grid)).q) < 1e-10);

    corrected.load = LoadCorrection{{{10.0, 1.0}, {40.0, 0.4}}};  // falls linearly with time: f = 10 + 30 t
    Eigen::Matrix3Xd falling = load;
    for (int k = 0; k < grid.samples; ++k) falling.col(k) *= 1 - 0.6 * grid.sampleTime(k);
    CHECK(test::calcRelativeError(ForwardModel(corrected).simulate(drive).q,
                                  ForwardModel(model).simulate(Drive::makeLoad(times, falling, {}, grid)).q) < 0.02);

    const Drive constant = Drive::makeLoad(times, Eigen::Matrix3Xd::Ones(3, grid.samples), {}, grid);
    CHECK_THROWS_AS(ForwardModel(corrected).simulate(constant), InputError);
}
