#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <random>

#include "identify/motion/fourier.hpp"
#include "identify/problem/unseen_noise.hpp"
#include "models/common/units.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

constexpr int kSamples = 1 << 16, kChannels = 3;
constexpr double kInterval = 5e-4, kLowest = 10, kHighest = 100;

/// Gaussian, with the variance of a sample, as white noise, that a function of frequency says.
template <class Function>
Eigen::MatrixXd drawShaped(const Function& density, std::mt19937_64& random) {
    const Fourier fourier(kSamples);
    std::normal_distribution<double> normal(0, 1);
    Eigen::MatrixXcd spectra = Eigen::MatrixXcd::Zero(kChannels, fourier.binCount());
    for (Eigen::Index b = 1; b + 1 < spectra.cols(); ++b)
        for (Eigen::Index c = 0; c < kChannels; ++c)
            spectra(c, b) = std::sqrt(0.5 * kSamples * density(static_cast<double>(b) / (kSamples * kInterval))) *
                            std::complex<double>(normal(random), normal(random));
    return fourier.inverse(spectra, kSamples);
}

NoiseDensity estimate(const Eigen::MatrixXd& values) {
    return estimateNoiseBesideBand(values, kChannels, {kLowest, kHighest, 13, 0}, kInterval, kLowest / 4, 0);
}

bool isDriven(double f) {
    return f >= kLowest && f <= kHighest;
}

}  // namespace

TEST_CASE("Under a random drive noise is what stands beside the band", "[noise density]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    for (const double pink : {0.0, 30.0, 300.0}) {
        CAPTURE(pink);
        const auto noise = [&](double f) { return 1 + pink / f; };
        const NoiseDensity density =
            estimate(drawShaped([&](double f) { return noise(f) + (isDriven(f) ? 1e6 : 0); }, random));
        // The least of three octaves, each of which scatters: of the part that falls with frequency up to 40 % less.
        for (const double f : {10.0, 30.0, 100.0, 400.0}) {
            CAPTURE(f, density.at(f));
            CHECK(density.at(f) > 1 + 0.6 * pink / f - 0.15);
            CHECK(density.at(f) < 1.15 * noise(f) + 0.15);
        }
    }
}

TEST_CASE("What a part does below the band is no noise in it", "[noise density]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    SECTION("a drive at 1 % where its band begins, 12 dB an octave below") {
        const NoiseDensity density = estimate(drawShaped(
            [&](double f) {
                return 1 + (isDriven(f) ? 1e4 : f < kLowest ? 1e2 * std::pow(f / kLowest, 4) : 0);
            },
            random));
        for (const double f : {10.0, 30.0, 100.0}) CHECK(density.at(f) == Approx(1).margin(0.4));
    }
    SECTION("what stops make of the drive, at all frequencies down to zero") {
        const NoiseDensity density =
            estimate(drawShaped([&](double f) { return 1 + (isDriven(f) || f < kLowest ? 1e4 : 0); }, random));
        // The octave at 1 Hz alone would allow 100 of it at 100 Hz. From 200 to 600 Hz noise is known to a thirtieth,
        // and as much of it may fall as 1/f.
        CHECK(density.at(100) > 0.6);
        CHECK(density.at(100) < 2);
    }
    SECTION("creep, a thousand times the noise at a tenth of the band's begin") {
        const NoiseDensity density = estimate(drawShaped(
            [&](double f) { return 1 + (isDriven(f) ? 1e4 : 1e3 * std::pow(10 * f / kLowest, -6)); }, random));
        for (const double f : {10.0, 30.0, 100.0}) CHECK(density.at(f) == Approx(1).margin(0.4));
    }
}

TEST_CASE("Lines of the mains above the band are no noise between them", "[noise density]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    Eigen::MatrixXd values = drawShaped([](double f) { return 1 + (isDriven(f) ? 1e4 : 0); }, random);
    for (int k = 0; k < kSamples; ++k)
        for (const double f : {150.0, 250.0, 350.0, 450.0, 550.0})
            values.col(k).array() += 10 * std::sin(kTwoPi * f * k * kInterval);
    const NoiseDensity density = estimate(values);
    for (const double f : {10.0, 30.0, 100.0, 400.0}) CHECK(density.at(f) == Approx(1).margin(0.4));
}

// A stop that is touched ten times a second leaves none of the windows alone in which the driven band is resolved. A
// part that comes to rest has gained no velocity: what a contact does to an acceleration has no mean.
TEST_CASE("A stop that is touched now and then is no noise", "[noise density]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    constexpr double rate = 10, lasts = 4e-3;  // Hz, s
    Eigen::MatrixXd values = drawShaped([](double f) { return 1 + (isDriven(f) ? 1e4 : 0); }, random);
    const int contacts = std::poisson_distribution<int>(rate * kSamples * kInterval)(random);
    const auto length = static_cast<Eigen::Index>(lasts / kInterval);
    std::uniform_int_distribution<Eigen::Index> begin(0, kSamples - length);
    std::uniform_real_distribution<double> peak(-1000, 1000);
    for (int i = 0; i < contacts; ++i) {
        const Eigen::Index first = begin(random);
        const double height = peak(random);
        for (Eigen::Index k = 0; k < length; ++k)
            values.col(first + k).array() +=
                height * std::sin(kTwoPi * (static_cast<double>(k) + 0.5) / static_cast<double>(length));
    }
    const NoiseDensity density = estimate(values);
    for (const double f : {200.0, 500.0}) CHECK(density.at(f) == Approx(1).margin(0.4));
}

// Below a sweep a channel without redundancy shows motion too: no more of it is noise than 1/f noise would be.
TEST_CASE("Noise below a sweep is limited by what it is in it", "[noise density]") {
    NoiseDensity density(2.5, {1000, 300, 20, 6, 4, 3, 2, 2});
    density.limitBelow(10);
    const double expected[] = {1000, 16, 8, 16 / 3.0, 4, 3, 2, 2};
    CHECK(density.at(0) == Approx(32));
    for (int k = 1; k < 8; ++k) CHECK(density.at(2.5 * k) == Approx(expected[k]));
}
