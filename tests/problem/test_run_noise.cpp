#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <random>

#include "identify/motion/fourier.hpp"
#include "identify/problem/run_noise.hpp"
#include "models/common/units.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

OpenLoopRun makeRun(int samples) {
    OpenLoopRun run;
    run.interval = run.raw_interval = 1e-3;
    run.time = Eigen::VectorXd::LinSpaced(samples, 0, (samples - 1) * run.interval);
    run.taper = Eigen::VectorXd::Ones(samples);
    for (int k = 0; k < 50; ++k) run.taper[k] = run.taper[samples - 1 - k] = k / 50.0;
    return run;
}

}  // namespace

// Slow noise that a stop lets through a tenth of the time: the mean power of many draws, some 2 % of chance in each
// band: never 15 %, which is exceeded by far by what the noise at each frequency alone would say.
TEST_CASE("Noise behind a stop has the power of all frequencies, modulated") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<> normal;
    constexpr int samples = 1000, draws = 500;
    const OpenLoopRun run = makeRun(samples);
    const EquationSpectra spectra(run, 5, 200);
    const Fourier fourier(samples);
    Eigen::RowVectorXd density(spectra.densityCount());
    for (Eigen::Index k = 0; k < density.size(); ++k)
        density[k] = 1 / (1 + std::pow(spectra.densityFrequency(k) / 4, 4));
    Eigen::RowVectorXd stop = Eigen::RowVectorXd::Zero(samples);
    for (int k = 0; k < samples; ++k)
        if (std::sin(0.07 * k) > 0.95) stop[k] = 3;
    const Eigen::VectorXd expected = spectra.calcModulated(stop, density);
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(expected.size());
    for (int draw = 0; draw < draws; ++draw) {
        Eigen::MatrixXcd spectrum(1, fourier.binCount());
        const double size = fourier.size();
        for (Eigen::Index k = 0; k < spectrum.cols(); ++k)
            spectrum(0, k) = std::sqrt(0.5 * density[k] * size) * std::complex<double>(normal(random), normal(random));
        spectrum(0, 0) = std::sqrt(density[0] * size) * normal(random);
        const Eigen::RowVectorXd noise = fourier.inverse(spectrum, samples);
        mean += spectra.transform(noise.cwiseProduct(stop)).row(0).cwiseAbs2().transpose() / draws;
    }
    constexpr Eigen::Index bands = 6;
    const Eigen::Index width = expected.size() / bands;
    for (Eigen::Index band = 0; band < bands; ++band) {
        CAPTURE(band);
        CHECK(mean.segment(band * width, width).mean() ==
              Approx(expected.segment(band * width, width).mean()).epsilon(0.15));
    }
    // What the noise at each frequency alone would say is at 200 Hz three decades too little, at least.
    const double even = stop.squaredNorm() / samples * run.taper.squaredNorm();
    CHECK(expected.tail(1)[0] > 1e3 * even / (1 + std::pow(200.0 / 4, 4)));
}

// Where the noise is white a stop makes white noise of it.
TEST_CASE("White noise behind a stop has its mean square") {
    const OpenLoopRun run = makeRun(800);
    const EquationSpectra spectra(run, 10, 300);
    Eigen::RowVectorXd stop = Eigen::RowVectorXd::Zero(800);
    stop.segment(100, 40).setConstant(2e5);
    stop.segment(500, 90).setConstant(1e5);
    const double variance = 1e-12;
    const Eigen::VectorXd power =
        spectra.calcModulated(stop, Eigen::RowVectorXd::Constant(spectra.densityCount(), variance));
    const double expected = variance * stop.cwiseProduct(run.taper.transpose()).squaredNorm();
    for (const double value : power) CHECK(value == Approx(expected));
}

// The spectrum of a tone, mean over a fifth of the lowest excited frequency about each bin: the same within a tenth on
// either side, nothing beyond: a Hann taper leaves less than a hundred thousandth eight bins of 0.12 Hz from a tone.
TEST_CASE("Power is smoothed over a fifth of the lowest excited frequency") {
    constexpr int samples = 8192;
    OpenLoopRun run = makeRun(samples);
    run.band.lowest = 20;
    for (int k = 0; k < samples; ++k) run.taper[k] = 0.5 - 0.5 * std::cos(kTwoPi * (k + 0.5) / samples);
    const EquationSpectra spectra(run, 30, 90);
    const Eigen::MatrixXd tone = (kTwoPi * 60 * run.time.array()).sin().matrix().transpose();
    const Eigen::MatrixXd power = spectra.calcPower(tone);
    double at_tone = 0;
    for (Eigen::Index k = 0; k < power.cols(); ++k) at_tone = std::max(at_tone, power(0, k));
    int inside = 0, outside = 0;
    for (Eigen::Index k = 0; k < power.cols(); ++k) {
        const double away = std::abs(spectra.frequency(k) - 60);
        CAPTURE(away, power(0, k), at_tone);
        if (away < 1.4 && ++inside > 0) CHECK(power(0, k) > 0.99 * at_tone);
        if (away > 3 && ++outside > 0) CHECK(power(0, k) < 1e-5 * at_tone);
    }
    CHECK(inside > 10);
    CHECK(outside > 100);
}
