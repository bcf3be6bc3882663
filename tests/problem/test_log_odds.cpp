// What bursts of noise leave of a difference of chi-squared.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/updating/log_odds.hpp"
#include "tests/seed.hpp"

namespace wems::identify::updating {
namespace {

/// A line through noise that is ten times as large in a tenth of the samples, of the mean variance that is believed.
struct Burst {
    Eigen::VectorXd column, deviation;  // of the number; of each sample, over the believed one

    explicit Burst(std::mt19937_64& random) : column(kSamples), deviation(kSamples) {
        std::normal_distribution<double> normal;
        for (Eigen::Index k = 0; k < kSamples; ++k) {
            const bool contact = k < kSamples / 10;
            deviation[k] = contact ? 10 : 1;
            column[k] = (contact ? 1.0 : 0.3) * normal(random);
        }
        deviation /= std::sqrt(deviation.squaredNorm() / kSamples);
    }

    Information makeInformation() const {
        Information all;
        BlockInformation& block = all[indexOf(Block::mount)];
        block.A = column.transpose() * column;
        block.b = Eigen::VectorXd::Zero(1);
        block.noise_slopes = Eigen::MatrixXd::Zero(1, 0);
        block.count = kSamples;
        const double variance = column.cwiseProduct(deviation).squaredNorm();
        block.scatter = Eigen::MatrixXd::Constant(1, 1, variance) - block.A;
        return all;
    }

    static constexpr Eigen::Index kSamples = 200;
};

const Eigen::VectorXd kFar = Eigen::VectorXd::Constant(1, 1e6), kStep = Eigen::VectorXd::Ones(1);

}  // namespace

// The fit of one number lowers chi-squared by that of one variable in the mean, if noise is what it is believed to be.
TEST_CASE("A number that bursts of noise move takes one of chi-squared as it counts", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const Burst burst(random);
    const Information all = burst.makeInformation();
    const double known = calcKnownPart(all, {}, kFar, kStep);
    const int draws = 4000;
    double taken = 0;
    for (int n = 0; n < draws; ++n) {
        double along = 0;
        for (Eigen::Index k = 0; k < Burst::kSamples; ++k)
            along += burst.column[k] * burst.deviation[k] * normal(random);
        taken += along * along / burst.column.squaredNorm() / draws;
    }
    CAPTURE(known, taken);
    CHECK(taken > 2);  // as it stands, it would pass for knowledge
    // Four standard deviations of the mean of that many squares.
    CHECK(known * taken == Approx(1).margin(4 * std::sqrt(2.0 / draws)));
}

TEST_CASE("Steady noise leaves all of chi-squared", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    Information all = Burst(random).makeInformation();
    CHECK(calcKnownPart(all, {}, kFar, kStep) < 1);
    all[indexOf(Block::mount)].scatter.resize(0, 0);
    CHECK(calcKnownPart(all, {}, kFar, kStep) == Approx(1));
    // A step that nothing is seen of changes nothing either.
    CHECK(calcKnownPart(all, {}, kFar, Eigen::VectorXd::Zero(1)) == 1);
}

}  // namespace wems::identify::updating
