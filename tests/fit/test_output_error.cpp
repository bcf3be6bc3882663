// Fits to free simulations of recordings that are too coarse for derivatives.
#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <random>

#include "identify/fit/output_error.hpp"
#include "identify/fit/output_error_interval.hpp"
#include "identify/fit/trajectory_problem.hpp"
#include "models/common/error.hpp"
#include "models/parameter_access.hpp"
#include "models/sensor_reading.hpp"
#include "tests/fit/coarse_oscillator.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

const std::vector<std::string> kDisplacement = {"mobile.1.z"};
const std::vector<std::string> kFree = {"1.z.cubic", "body.mass"};

FitResult fitRecording(const Recording& recording, const MountModel& model, const std::vector<std::string>& free) {
    FitOptions options;
    options.free_body = free;
    return fitBySimulation({estimateMotion(recording, model)}, model, options, kDisplacement);
}

/// Draws devices, fits each from a model that is off by up to a third, and counts intervals that hold.
struct Coverage {
    int intervals = 0, held = 0, fits = 0;
    double worst = 0;  // standard errors
};
Coverage measureCoverage(int cases, int samples, std::mt19937_64& random) {
    Coverage coverage;
    for (int c = 0; c < cases; ++c) {
        const test::CoarseOscillator device = test::drawOscillator(random);
        const Recording recording = test::recordOscillator(device, samples, c % 2 == 0, 3e-3, random());
        const MountModel truth = device.makeModel();
        const FitResult fit = fitRecording(recording, test::mistake(truth, 1.35, random), kFree);
        CAPTURE(c, device.mass, device.stiffness, device.damping, device.cubic, fit.residual_fraction);
        CHECK(fit.residual_fraction < 4e-3);
        CHECK(fit.parameters.size() == 6);
        ++coverage.fits;
        for (const FittedParameter& parameter : fit.parameters) {
            const double error = std::abs(parameter.value - getParameter(truth, parameter.name));
            ++coverage.intervals;
            if (error <= parameter.interval95[1] - parameter.value) ++coverage.held;
            coverage.worst = std::max(coverage.worst, error / parameter.standard_error);
        }
    }
    return coverage;
}

}  // namespace

TEST_CASE("Coarse displacements and a load give mass, stiffness, damping, hardening and both zeros") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const Coverage coverage = measureCoverage(8, 1500, random);
    CAPTURE(coverage.held, coverage.intervals, coverage.worst);
    CHECK(coverage.intervals == 48);
    CHECK(coverage.held >= 40);  // of 48 at 95 %, less are seen once in a thousand times
    CHECK(coverage.worst < 5);
}

TEST_CASE("Intervals of fits to simulations, many draws", "[.simulated]") {
    std::mt19937_64 random(test::drawSeed());
    const Coverage coverage = measureCoverage(100, 2500, random);
    WARN(coverage.held << " of " << coverage.intervals << " intervals hold, the farthest value is " << coverage.worst
                       << " standard errors away");
    CHECK(coverage.held >= 0.93 * coverage.intervals);
}

TEST_CASE("At the truth a simulation leaves the noise alone") {
    std::mt19937_64 random(test::drawSeed());
    const test::CoarseOscillator device = test::drawOscillator(random);
    const Recording recording = test::recordOscillator(device, 1500, true, 0, random());
    const MountModel truth = device.makeModel();
    const std::vector<RunMotion> motions{estimateMotion(recording, truth)};
    TrajectoryRuns runs(motions, truth, 8);
    REQUIRE(runs.listQuietStarts() == std::vector<std::size_t>{0});
    runs.setAtRest(0, true);
    TrajectoryProblem problem(runs, runs.keepWhole(), truth, {"1.z.stiffness"});
    TrajectoryPoint point = problem.start();
    REQUIRE(problem.layout().load_axes == std::vector<int>{2});
    point.others[problem.layout().restAt() - 1] = device.displacement_zero;
    point.others[problem.layout().loadAt() - 1] = device.load_zero;
    const double size = std::sqrt(problem.measuredSquares(0));
    // The load is interpolated, the first samples without what was before them.
    CHECK(problem.calcResidual(0, point).norm() < 2e-3 * size);
    CHECK(problem.calcResidual(0, point).tail(1000).norm() < 1e-3 * size);
    // A zero of the sensor is read by every sample of its axis; x and y are held and no part of the residual.
    const TrajectoryTangent tangent = problem.linearise(0, point);
    REQUIRE(tangent.axes == 1);
    const Eigen::VectorXd column = tangent.jacobian.col(1) / problem.scale()[1];
    CHECK(column.isApproxToConstant(1, 1e-12));
}

TEST_CASE("Derivatives of simulations are those of central differences over wider steps") {
    std::mt19937_64 random(test::drawSeed());
    const test::CoarseOscillator device = test::drawOscillator(random);
    const Recording recording = test::recordOscillator(device, 600, false, 1e-3, random());
    const MountModel model = device.makeModel();
    const std::vector<RunMotion> motions{estimateMotion(recording, model)};
    const TrajectoryRuns runs(motions, model, 1);
    TrajectoryProblem problem(runs, runs.keepWhole(), model, {"1.z.stiffness", "1.z.damping", "body.mass"});
    REQUIRE(problem.layout().start_counts == std::vector<int>{2});
    const TrajectoryTangent tangent = problem.linearise(0, problem.start());
    REQUIRE(tangent.jacobian.cols() == problem.layout().size());
    for (Eigen::Index j = 0; j < problem.layout().size(); ++j) {
        CAPTURE(j);
        constexpr double step = 1e-4;
        const Eigen::VectorXd unit = step * Eigen::VectorXd::Unit(problem.layout().size(), j);
        const Eigen::VectorXd slope = (problem.calcResidual(0, problem.move(problem.start(), unit)) -
                                       problem.calcResidual(0, problem.move(problem.start(), -unit))) /
                                      (2 * step);
        CHECK((slope - tangent.jacobian.col(j)).norm() < 2e-3 * slope.norm());
    }
}

TEST_CASE("What a free decay cannot tell is said: mass and stiffness, but for their ratio") {
    std::mt19937_64 random(test::drawSeed());
    test::CoarseOscillator device = test::drawOscillator(random);
    device.cubic = device.load_zero = 0;
    Recording recording = test::recordOscillator(device, 800, false, 0, random());
    // Of the load only what moved it before the first sample is left: a decay of its linear law, in closed form.
    const double omega = std::sqrt(device.stiffness / device.mass), decay = device.damping / (2 * device.mass);
    const double ringing = std::sqrt(omega * omega - decay * decay);
    std::normal_distribution<double> noise(0, 1e-3 * device.rms);
    for (std::size_t k = 0; k < recording.time.size(); ++k) {
        const double t = recording.time[k];
        recording.channels[0].values[k] = 0;
        recording.channels[1].values[k] = device.rms * std::exp(-decay * t) * std::cos(ringing * t) + noise(random);
    }
    const FitResult fit = fitRecording(recording, device.makeModel(), {"body.mass"});
    for (const FittedParameter& parameter : fit.parameters) CHECK(parameter.name == "mobile.1.z.zero");
    std::vector<std::string> open;
    for (const UnidentifiedGroup& group : fit.not_identifiable)
        open.insert(open.end(), group.names.begin(), group.names.end());
    for (const char* name : {"1.z.stiffness", "body.mass", "1.z.damping"})
        CHECK(std::find(open.begin(), open.end(), name) != open.end());
    // With the mass as believed, the rest is known.
    const FitResult known = fitRecording(recording, device.makeModel(), {});
    std::map<std::string, double> values;
    for (const FittedParameter& parameter : known.parameters) values[parameter.name] = parameter.value;
    CHECK(values["1.z.stiffness"] == Approx(device.stiffness).epsilon(2e-3));
    CHECK(values["1.z.damping"] == Approx(device.damping).epsilon(2e-2));
}

TEST_CASE("Zeros that an asymmetry may stand for are kept in the model, whose simulation holds") {
    std::mt19937_64 random(test::drawSeed());
    const test::CoarseOscillator device = test::drawOscillator(random);
    const Recording recording = test::recordOscillator(device, 1000, true, 3e-3, random());
    const MountModel believed = test::mistake(device.makeModel(), 1.2, random);
    const FitResult fit = fitRecording(recording, believed, {"1.z.cubic", "1.z.quadratic"});
    CHECK(fit.residual_fraction < 4e-3);
    const RunMotion run = estimateMotion(correctChannels(recording, fit.model.sensors), fit.model);
    CHECK(calcSimulationError(fit.model, prepareRun(run, fit.model, 0)).value() < 0.02);
}

TEST_CASE("A start far off is left by way of short pieces") {
    std::mt19937_64 random(test::drawSeed());
    for (const double factor : {0.6, 1.6}) {
        CAPTURE(factor);
        const test::CoarseOscillator device = test::drawOscillator(random);
        const Recording recording = test::recordOscillator(device, 1500, true, 3e-3, random());
        MountModel wrong = device.makeModel();
        wrong.sensors.clear();
        wrong.connections[0].axis[2].stiffness *= factor;
        wrong.connections[0].axis[2].damping *= 0.1;
        const FitResult fit = fitRecording(recording, wrong, kFree);
        CHECK(fit.residual_fraction < 4e-3);
    }
}

TEST_CASE("Numbers of nothing and recordings without displacements are refused") {
    std::mt19937_64 random(test::drawSeed());
    const test::CoarseOscillator device = test::drawOscillator(random);
    Recording recording = test::recordOscillator(device, 300, true, 1e-3, random());
    const MountModel model = device.makeModel();
    CHECK_THROWS_WITH(fitRecording(recording, model, {"1.z.elasticity"}),
                      Catch::Contains("--free 1.z.elasticity") && Catch::Contains("1.z.stiffness"));
    recording.channels[1].name = "mobile.1.az";
    recording.channels[2].name = "fixed.1.az";
    CHECK_THROWS_WITH(fitRecording(recording, model, {}), Catch::Contains("has no displacements"));
}

TEST_CASE("The covariance is that of coloured noise in closed form, and of stretches where noise is not the same") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    constexpr Eigen::Index samples = 4096;
    constexpr double a = 0.8;  // e_n = a e_{n-1} + w_n, autocovariance a^|l| / (1 − a²)
    TrajectoryTangent tangent;
    tangent.axes = 1;
    tangent.unknowns = {0, 1};
    tangent.jacobian.resize(samples, 2);
    for (Eigen::Index k = 0; k < samples; ++k)
        tangent.jacobian.row(k) << std::sin(0.05 * static_cast<double>(k)), std::cos(2.1 * static_cast<double>(k));
    Eigen::Matrix2d noise = Eigen::Matrix2d::Zero();
    for (Eigen::Index lag = -60; lag <= 60; ++lag) {
        const Eigen::Index from = std::max<Eigen::Index>(0, lag), count = samples - std::abs(lag);
        noise += std::pow(a, std::abs(lag)) / (1 - a * a) * tangent.jacobian.middleRows(from, count).transpose() *
                 tangent.jacobian.middleRows(from - lag, count);
    }
    const Eigen::Matrix2d U = (tangent.jacobian.transpose() * tangent.jacobian).inverse();
    const Eigen::Matrix2d exact = U * noise * U;
    Eigen::Matrix2d mean = Eigen::Matrix2d::Zero();
    constexpr int draws = 20;
    for (int d = 0; d < draws; ++d) {
        tangent.residual.resize(samples);
        double e = normal(random) / std::sqrt(1 - a * a);
        for (double& value : tangent.residual) {
            value = e;
            e = a * e + normal(random);
        }
        OutputErrorUncertainty uncertainty(2);
        uncertainty.add(tangent, 1);
        uncertainty.solve();
        mean += uncertainty.makeCovariance() / draws;
    }
    // The larger of two estimates: somewhat more than the truth on average, white noise would be nine times less.
    for (Eigen::Index j = 0; j < 2; ++j) {
        CAPTURE(j);
        CHECK(mean(j, j) > 0.85 * exact(j, j));
        CHECK(mean(j, j) < 1.5 * exact(j, j));
    }
    // Noise and derivative in the same eighth of the run: eight times the variance that noise spread evenly would give.
    // It is taken from few stretches, so that one draw may be half or twice of it.
    double variance = 0;
    constexpr int local_draws = 100;
    for (int d = 0; d < local_draws; ++d) {
        tangent.jacobian.setZero();
        tangent.residual.setZero();
        for (Eigen::Index k = 0; k < samples / 8; ++k) {
            tangent.jacobian.row(k) << 1, std::cos(2.1 * static_cast<double>(k));
            tangent.residual[k] = normal(random);
        }
        OutputErrorUncertainty local(2);
        local.add(tangent, 1);
        local.solve();
        variance += std::pow(local.calcStandardError(Eigen::Vector2d::UnitX()), 2) / local_draws;
    }
    CAPTURE(variance * samples);
    CHECK(variance > 6.0 / samples);
    CHECK(variance < 12.0 / samples);
}

}  // namespace wems::identify
