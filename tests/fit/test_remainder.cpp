// What a fit leaves, and how well it determines the parameters: against closed forms and a singular value
// decomposition.
#include <Eigen/LU>
#include <Eigen/SVD>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/fit/fit.hpp"
#include "identify/fit/stored_equations.hpp"
#include "models/common/units.hpp"
#include "tests/fit/synthetic_run.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

Eigen::VectorXd drawNoise(std::mt19937_64& random, int count) {
    std::normal_distribution<double> normal;
    Eigen::VectorXd series(count);
    for (double& value : series) value = normal(random);
    return series;
}

}  // namespace

TEST_CASE("Autocorrelation of a first-order process is its coefficient's powers") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const double a = std::uniform_real_distribution<double>(0.3, 0.8)(random);
    Eigen::VectorXd series = drawNoise(random, 100000);
    for (Eigen::Index n = 1; n < series.size(); ++n) series[n] += a * series[n - 1];
    const Eigen::VectorXd r = calcAutocorrelation(series, 8);
    for (int k = 0; k <= 8; ++k) {
        CAPTURE(k, a);
        CHECK(r[k] == Approx(std::pow(a, k)).margin(0.035));  // six standard errors at the largest a
    }
    CHECK(calcAutocorrelation(Eigen::VectorXd::Zero(10), 3).isZero());
}

TEST_CASE("One in twenty correlations of averaged noise is beyond the limit where averages share no samples") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    constexpr int kSeries = 400, kCount = 2000, kWidth = 4, kLags = 24;
    int beyond = 0;
    for (int i = 0; i < kSeries; ++i) {
        const Eigen::VectorXd noise = drawNoise(random, kCount + kWidth);
        Eigen::VectorXd averaged = Eigen::VectorXd::Zero(kCount);
        for (int k = 0; k < kWidth; ++k) averaged += noise.segment(k, kCount);
        const Eigen::VectorXd r = calcAutocorrelation(averaged, kLags);
        const double limit = calcAutocorrelationLimit(r.head(kWidth), kCount);
        for (int k = kWidth; k <= kLags; ++k) beyond += std::abs(r[k]) > limit ? 1 : 0;
    }
    const double share = static_cast<double>(beyond) / (kSeries * (kLags - kWidth + 1));
    CHECK(share == Approx(0.05).margin(0.02));
}

TEST_CASE("Singular values and directions are those of the weighted equations") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    std::vector<Parameter> parameters(4);
    for (int j = 0; j < 4; ++j) {
        parameters[j].name = std::to_string(j + 1) + ".z.stiffness";
        parameters[j].unit = "N/m";
    }
    Eigen::MatrixXd J(300, 4);
    for (Eigen::Index j = 0; j < 4; ++j) J.col(j) = 3 * drawNoise(random, 300);
    J.col(1) = J.col(0) + 1e-3 * drawNoise(random, 300);  // only their sum is known
    const Eigen::MatrixXd information = J.transpose() * J;
    const auto directions = findDirections(parameters, information, information.inverse());
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J);
    REQUIRE(directions.size() == 4);
    for (int d = 0; d < 4; ++d) {
        CAPTURE(d);
        const auto& direction = directions[d];
        CHECK(direction.singular_value == Approx(svd.singularValues()[d]).epsilon(1e-5));
        CHECK(direction.relative_error == Approx(1 / svd.singularValues()[d]).epsilon(1e-3));
        CHECK(direction.known == (d < 3));
    }
    const std::string& weakest = directions.back().text;
    CHECK((weakest == "0.707 1.z.stiffness - 0.707 2.z.stiffness" ||
           weakest == "0.707 2.z.stiffness - 0.707 1.z.stiffness"));
}

TEST_CASE("A force that no law of the mount can give is what the equations leave") {
    const MountModel device = readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
    test::SweepSettings settings;
    settings.force = {0, 0, 60};
    settings.octaves_per_minute = 30;
    RunMotion run = estimateMotion(test::record(test::simulateSweep(device, settings), {1e-7, 1e-3}, 3), device);
    // As if something shook the body along x, far above what the mount moves at.
    constexpr double hertz = 150, amplitude = 0.5;
    for (Eigen::Index k = 0; k < run.mobile.a.cols(); ++k)
        run.mobile.a(0, k) += amplitude * std::sin(2 * kPi * hertz * run.interval * static_cast<double>(k));
    const FitOptions options;
    const FitResult fit = fitMount({run}, device, options);
    REQUIRE(fit.remainders.size() == 1);
    const RunRemainder& left = fit.remainders.front();
    const double count = static_cast<double>(left.unexplained.cols());
    const double mean = makeRunEquations(run, device, options).test_function.response(hertz);
    const double force = device.body.mass * amplitude * mean / std::sqrt(2.0);
    const auto rms = [&](int row) { return left.unexplained.row(row).norm() / std::sqrt(count); };
    CHECK(rms(0) == Approx(force).epsilon(0.03));
    CHECK(rms(4) == Approx(force * device.body.center_of_gravity.z()).epsilon(0.03));
    CHECK(rms(1) < 0.02 * force);
    CHECK(rms(2) < 0.05 * force);
    CHECK(left.start + left.interval * (count - 1) <= run.time.back());
    CHECK(left.overlap >= 0);
    CHECK(calcUnexplainedFraction(fit.remainders, device) == fit.residual_fraction);
}

}  // namespace wems::identify
