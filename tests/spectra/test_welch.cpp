// Spectral densities against SciPy's values and against a slow transform.
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <cstdint>
#include <fstream>
#include <random>
#include <sstream>

#include "identify/spectra/welch.hpp"
#include "models/common/error.hpp"
#include "models/common/units.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

/// The same numbers in every language.
std::vector<double> drawNumbers(std::uint32_t state, int count) {
    std::vector<double> values;
    for (int k = 0; k < count; ++k) {
        state = 1664525U * state + 1013904223U;
        values.push_back(state / 4294967296.0 - 0.5);
    }
    return values;
}

/// A first-order system with noise at its output.
Eigen::MatrixXd makeSignals() {
    const int n = 1000;
    const auto x = drawNumbers(1, n), e = drawNumbers(2, n);
    Eigen::MatrixXd signals(n, 2);
    for (int k = 0; k < n; ++k) {
        signals(k, 0) = x[std::size_t(k)] + 0.3;
        signals(k, 1) = (k > 0 ? 0.7 * signals(k - 1, 0) + 0.2 * signals(k - 1, 1) : 0) + 0.1 * e[std::size_t(k)];
    }
    return signals;
}

}  // namespace

TEST_CASE("densities, cross density and coherence are SciPy's, for even and odd segments") {
    for (const int length : {128, 101}) {
        const CrossSpectra spectra = estimateSpectra(makeSignals(), 0, 1.0 / 200, {length});
        const TransferEstimate transfer = estimateTransfer(spectra, 1);
        std::ifstream file(std::string(WEMS_SOURCE_DIR "/tests/spectra/data/scipy_") + std::to_string(length) + ".csv");
        std::string line;
        std::getline(file, line);
        std::getline(file, line);
        Eigen::Index k = 0;
        for (; std::getline(file, line); ++k) {
            double f = 0, xx = 0, yy = 0, re = 0, im = 0, coherence = 0;
            REQUIRE(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf", &f, &xx, &yy, &re, &im, &coherence) == 6);
            CAPTURE(length, k);
            const double scale = spectra.density(20, 0);
            CHECK(spectra.frequency[k] == Approx(f).margin(1e-12));
            CHECK(spectra.density(k, 0) == Approx(xx).epsilon(1e-12).margin(1e-15 * scale));
            CHECK(spectra.density(k, 1) == Approx(yy).epsilon(1e-12).margin(1e-15 * scale));
            CHECK(std::abs(spectra.cross(k, 1) - std::complex<double>(re, im)) < 1e-13 * scale);
            if (k > 0) CHECK(transfer.coherence[k] == Approx(coherence).epsilon(1e-11));
        }
        CHECK(k == spectra.frequency.size());
    }
}

TEST_CASE("a sine's density integrates to its mean square; a mean does not count") {
    const int n = 4096;
    Eigen::MatrixXd signal(n, 1);
    for (int k = 0; k < n; ++k) signal(k, 0) = 5 + 3 * std::sin(kTwoPi * 64.0 * k / 1024);  // bin 64 of 1024 samples
    const CrossSpectra spectra = estimateSpectra(signal, 0, 1e-3, {1024});
    CHECK(spectra.density.sum() * spectra.resolution == Approx(4.5).epsilon(1e-10));
    CHECK(spectra.segments == 7);
    CHECK_THROWS_AS(estimateSpectra(signal, 0, 1e-3, {5000}), InputError);
    CHECK_THROWS_AS(estimateSpectra(signal, 0, 1e-3, {4}), InputError);
    CHECK(chooseSegment(4096, 20) == 256);
}

TEST_CASE("degrees of freedom: the scatter of densities of white noise has that variance") {
    const auto seed = GENERATE(1u, 2u);
    CAPTURE(seed);
    std::mt19937 generator(seed);
    std::normal_distribution<double> normal;
    const int n = 4096, runs = 720, length = 256;
    double sum = 0, square = 0, nu = 0;
    long count = 0;
    for (int run = 0; run < runs; ++run) {
        Eigen::MatrixXd noise(n, 1);
        for (double& value : noise.reshaped()) value = normal(generator);
        const CrossSpectra spectra = estimateSpectra(noise, 0, 1, {length});
        nu = spectra.degrees_of_freedom;
        for (Eigen::Index k = 4; k < length / 2 - 4; k += 4) {  // bins far enough apart to be independent
            sum += spectra.density(k, 0);
            square += std::pow(spectra.density(k, 0), 2);
            ++count;
        }
    }
    const double mean = sum / double(count), variance = square / double(count) - mean * mean;
    // One-sided, unit variance at 1 Hz. Of 22 320 values of ν = 59 degrees of freedom the standard deviation is
    // √(2/ν/22 320) = 0.12 %; four of them.
    CHECK(mean == Approx(2).epsilon(0.005));
    // 2/ν of the square, with a standard deviation of √((2 + 12/ν)/22 320) = 1 %: beyond 3.5 % once in 2000 times.
    // Segments taken as independent, ν = 62, are 5.4 % off, which is seen in 97 of 100; every second segment alone is
    // 84 % off.
    CHECK(variance / (mean * mean) == Approx(2 / nu).epsilon(0.035));
    CHECK(nu > 31);  // 31 segments, half overlapping: less than 62, more than from 16 alone
    CHECK(nu < 62);
}

TEST_CASE("chi-square quantiles are SciPy's") {
    CHECK(chiSquareQuantile(1, 0.025) == Approx(0.0009820691171752555).epsilon(1e-10));
    CHECK(chiSquareQuantile(7.3, 0.975) == Approx(16.473245004110147).epsilon(1e-10));
    CHECK(chiSquareQuantile(40, 0.025) == Approx(24.433039170807888).epsilon(1e-10));
    CHECK(chiSquareQuantile(400, 0.975) == Approx(457.305481966065).epsilon(1e-10));
    CHECK(densityInterval95(40).lower < 1);
    CHECK(densityInterval95(40).upper > 1);
}
