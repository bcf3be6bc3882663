#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/catalogue/modal_scan.hpp"
#include "models/common/units.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

using Complex = std::complex<double>;

/// What a mode leaves where the model lacks it, in noise of unit variance after whitening.
struct Planted {
    double frequency, damping_ratio;
    Eigen::VectorXd participation;
};

ModalScan makeScan(const Planted& planted, double noise, std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    const auto draw = [&] { return Complex(normal(random), normal(random)); };
    const auto inputs = planted.participation.size();
    ModalScan scan(4, 100, inputs, 0.1);
    for (double f = 4; f < 100; f += 0.05) {
        Eigen::VectorXcd input(inputs);
        for (auto& value : input) value = 50.0 * draw();
        const double w = kTwoPi * f, w0 = kTwoPi * planted.frequency;
        const Complex response = 1.0 / Complex(w0 * w0 - w * w, 2 * planted.damping_ratio * w0 * w);
        const Complex coordinate = response * (planted.participation.cast<Complex>().transpose() * input)(0);
        const ModalScan::Matrix6c factor = ModalScan::Matrix6c::Identity() / noise;
        ModalScan::Vector6c white = -factor * planted.participation.head<6>().cast<Complex>() * coordinate;
        for (auto& value : white) value += draw() / std::sqrt(2.0);
        scan.add(f, input, factor, white);
    }
    return scan;
}

}  // namespace

TEST_CASE("A scan finds a mode's frequency, damping and shape", "[diagnose]") {
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const Eigen::Index inputs = GENERATE(6, 8);
    Planted planted{40 + 20 * uniform(random), 0.012 + 0.005 * uniform(random), Eigen::VectorXd(inputs)};
    for (auto& value : planted.participation) value = 0.1 * uniform(random);
    planted.participation[0] = 0.15;
    const auto best = makeScan(planted, 1e-6, random).findBest(2);
    REQUIRE_FALSE(best.empty());
    CHECK(best[0].frequency == Approx(planted.frequency).epsilon(2e-3));
    CHECK(best[0].damping_ratio == Approx(planted.damping_ratio).epsilon(0.1));
    const double sign = best[0].participation[0] > 0 ? 1 : -1;
    // At the resonance the shape's square goes with the damping ratio, which may be 10 % off.
    CHECK((sign * best[0].participation - planted.participation).norm() < 0.06 * planted.participation.norm());
}

TEST_CASE("Noise alone promises little", "[diagnose]") {
    std::mt19937_64 random(5);
    const Planted nothing{30, 0.01, Eigen::VectorXd::Zero(6)};
    // Eight numbers fitted to noise of unit variance, the best of a hundred places.
    for (const auto& guess : makeScan(nothing, 1e-6, random).findBest(3)) CHECK(guess.gain < 60);
}
