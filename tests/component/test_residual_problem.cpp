// Fits and evidence of a residual of unknown size against the condition of an optimum and an integral by sums.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/residual/residual_problem.hpp"
#include "identify/residual/residual_search.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

constexpr double kDeviation = 0.05, kReach = 1.5;

/// y = a x₁ + b x₂ + noise: a is believed to be 1 within a tolerance, b is a mechanism that may be missing.
class Line : public ResidualProblem {
public:
    Line(double a, double b, std::uint64_t seed) {
        std::mt19937_64 random(seed);
        std::normal_distribution<> normal;
        x_.resize(2, 150);
        for (double& value : x_.reshaped()) value = normal(random);
        y_ = a * x_.row(0) + b * x_.row(1);
        for (double& value : y_) value += 0.3 * normal(random);
        for (const auto& [name, believed, deviation] : {std::tuple("a", 1.0, kDeviation), std::tuple("b", 0.0, 0.0)}) {
            Unknown row;
            row.name = name;
            row.believed = believed;
            row.deviation = deviation;
            row.reach = kReach;
            row.step = 1e-4;
            table_.push_back(row);
        }
        Hypothesis b_is_there;
        b_is_there.cause = "b";
        b_is_there.where = {"1.z"};
        b_is_there.directions = {{{1, kReach}}};
        b_is_there.reported = {1};
        b_is_there.log_prior = std::log(0.1);
        hypotheses_ = {b_is_there};
    }

    Eigen::VectorXd calcResidual(const Eigen::VectorXd& values) const override { return y_ - x_.transpose() * values; }
    double calcSignalSquare() const override { return y_.squaredNorm(); }
    GroupError calcErrors(const Eigen::VectorXd& values) const override {
        const double error = calcResidual(values).norm() / y_.norm();
        return {error, error};
    }
    GroupError calcNoiseFloor() const override { return {0.1, 0.1}; }
    double calcJudgedDifference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const override {
        return (x_.transpose() * (a - b)).squaredNorm() / y_.squaredNorm();
    }

private:
    Eigen::MatrixXd x_;
    Eigen::VectorXd y_;
};

/// log ∫ RSS(z)^(−N/2) N(z; 0, 1) dz over both unknowns (`with_b`) or the first alone, by sums over a grid.
double integrate(const Line& line, double samples, bool with_b) {
    constexpr double kFar = 6, kStep = 0.02;
    const double reference = line.calcResidual(line.believedValues()).squaredNorm();
    double sum = 0;
    const int steps = static_cast<int>(2 * kFar / kStep);
    for (int i = 0; i <= steps; ++i)
        for (int j = 0; j <= (with_b ? steps : 0); ++j) {
            const double z = -kFar + i * kStep, w = with_b ? -kFar + j * kStep : 0;
            const double rss = line.calcResidual(Eigen::Vector2d(1 + kDeviation * z, kReach * w)).squaredNorm();
            sum += std::exp(-0.5 * (samples * std::log(rss / reference) + z * z + w * w));
        }
    const int unknowns = with_b ? 2 : 1;
    return std::log(sum) + unknowns * std::log(kStep / std::sqrt(2 * M_PI)) - 0.5 * samples * std::log(reference);
}

}  // namespace

TEST_CASE("ResidualProblem: the fit is the optimum, its evidence the integral over the unknowns") {
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    const Line line(1.04, 0.2, seed);
    const double samples = 120;
    for (const bool with_b : {false, true}) {
        const HypothesisSet set = with_b ? HypothesisSet{0} : HypothesisSet{};
        const ResidualFit fit = line.fit(set, samples, line.believedValues());
        CAPTURE(with_b, fit.values.transpose());
        CHECK(fit.sum_of_squares == Approx(line.calcResidual(fit.values).squaredNorm()));
        // At the most probable numbers what the data pull is what the prior holds: N / RSS Jᵀ r = z. The search ends
        // where a step gains less than 0.05, about a third of a standard deviation of z.
        Eigen::VectorXd z(with_b ? 2 : 1);
        z[0] = (fit.values[0] - 1) / kDeviation;
        if (with_b) z[1] = fit.values[1] / kReach;
        REQUIRE(fit.slopes.cols() == z.size());
        const Eigen::VectorXd pull = samples / fit.sum_of_squares * fit.slopes.transpose() * fit.residual;
        const Eigen::MatrixXd H = samples / fit.sum_of_squares * fit.slopes.transpose() * fit.slopes +
                                  Eigen::MatrixXd::Identity(z.size(), z.size());
        CHECK((pull - z).dot(H.ldlt().solve(pull - z)) < 0.1);
        // Laplace's approximation of 120 samples with one or two unknowns errs by some hundredths.
        CHECK(fit.log_evidence ==
              Approx(integrate(line, samples, with_b) + (with_b ? std::log(0.1) : 0.0)).margin(0.1));
        CHECK(std::sqrt(fit.covariance(0, 0)) <= kDeviation);
    }
    const ResidualFit held = line.fit({0}, samples, line.believedValues(), {{0, 1.02}});
    CHECK(held.values[0] == 1.02);
    CHECK(held.covariance(0, 0) == 0);
}

TEST_CASE("ResidualProblem: independent values of a residual that remembers") {
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    std::normal_distribution<> normal;
    const double rho = 0.8;
    Eigen::VectorXd residual(20000);
    double last = 0;
    for (double& value : residual) value = last = rho * last + std::sqrt(1 - rho * rho) * normal(random);
    // 1 + 2 Σ ρᵏ = (1 + ρ)/(1 − ρ) = 9, less what lies below 0.05 (0.04); it scatters by some 6 %.
    CHECK(ResidualProblem::countSamples(residual) == Approx(20000.0 / 9).epsilon(0.25));
    for (double& value : residual) value = normal(random);
    CHECK(ResidualProblem::countSamples(residual) == Approx(20000).epsilon(0.01));
}

TEST_CASE("searchCauses: a mechanism that is there is named, one that is not is left out") {
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    std::vector<std::string> steps;
    const auto listen = [&](const ProgressEvent& step) { steps.push_back(step.what); };
    // 0.5 is twenty standard errors; without it, odds of 0.1 and Occam's factor of some 60 stand against chance.
    const Line there(1.03, 0.5, seed), absent(1.03, 0, seed);
    const ResidualAnswer named = searchCauses(there, listen), none = searchCauses(absent, {});
    CHECK_FALSE(steps.empty());
    CHECK(named.best.set == HypothesisSet{0});
    CHECK(named.best.values[1] == Approx(0.5).margin(0.12));
    CHECK(none.best.set.empty());
    CHECK(leaveOut(there, named.best, 0).values[1] == 0);
}

}  // namespace wems::identify
