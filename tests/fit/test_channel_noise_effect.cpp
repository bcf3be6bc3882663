// The variances that the channels' noise gives a solution, beside noise that is drawn and goes through the equations.
#include <Eigen/Cholesky>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "identify/fit/channel_noise_effect.hpp"
#include "identify/fit/parameter_set.hpp"
#include "identify/fit/solver.hpp"
#include "models/mount_model.hpp"
#include "tests/fit/synthetic_run.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

/// Root of a covariance that has one.
Matrix6d rootOf(const Matrix6d& covariance) {
    return covariance.llt().matrixL();
}

/// Adds white noise of this deviation of a channel to a part's motion, which keeps its small rotations.
void disturb(PartMotion& part, double deviation, std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    const Matrix6d root = deviation * rootOf(part.displacement_covariance);
    for (Eigen::Index k = 0; k < part.p.cols(); ++k) {
        const Vector6d noise = root * Vector6d::NullaryExpr([&] { return normal(random); });
        part.p.col(k) += noise.head<3>();
        part.theta.col(k) += noise.tail<3>();
    }
}

}  // namespace

TEST_CASE("Variances by the channels' noise are those of noise that is drawn") {
    const MountModel model = readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    test::SweepSettings sweep;
    sweep.force = {60, 40, 500};
    sweep.from = 25;
    sweep.to = 38;
    sweep.octaves_per_minute = 40;
    sweep.sample_rate = 1000;
    sweep.steps_per_sample = 8;
    constexpr double kDeviation = 1e-7;  // m; to first order in contact
    std::vector<RunMotion> runs{
        estimateMotion(test::record(test::simulateSweep(model, sweep), {kDeviation, -1}, seed), model)};
    const TestFunction test_function(3, runs[0].interval);
    NormalEquations equations({makeEquations(runs[0], model, test_function, false)});
    Solver solver(runs, equations, makeParameters(model, {}), model);
    solver.run();
    const LinearSystem system = solver.linearise();
    const Eigen::VectorXd variances = calcChannelNoiseVariances(solver, system);
    REQUIRE(variances.size() == system.scale.size());
    REQUIRE(variances.minCoeff() > 0);

    const RowMatrix sensitivity = solver.calcSensitivity(0, system);
    const Eigen::VectorXd before = solver.calcResidual(0);
    std::mt19937_64 random(seed);
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(variances.size());
    constexpr int kRepetitions = 200;  // variances then scatter by 10 %
    for (int repetition = 0; repetition < kRepetitions; ++repetition) {
        std::vector<RunMotion> noisy = runs;
        disturb(noisy[0].mobile, kDeviation, random);
        disturb(noisy[0].fixed, kDeviation, random);
        NormalEquations own({makeEquations(noisy[0], model, test_function, false)});
        own.whiten({equations.whitening(0)});
        own.setStops(solver.model(), equations.stops());
        const RowMatrix after = own.apply(0, own.makeCoefficients(solver.model()));
        squares += (system.inverse * (sensitivity.transpose() * (after.col(0) - before))).cwiseAbs2();
    }
    const Eigen::VectorXd ratios = variances.cwiseQuotient(squares / kRepetitions);
    CAPTURE(ratios.transpose());
    // Five deviations of the scatter, and the density's own by redundancy and quartile.
    CHECK(ratios.minCoeff() > 0.5);
    CHECK(ratios.maxCoeff() < 1.8);
    CHECK(ratios.mean() == Approx(1).epsilon(0.2));
}

}  // namespace wems::identify
