// Transfer estimates: known systems, and intervals that hold as often as they say.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/spectra/welch.hpp"
#include "models/common/units.hpp"

using namespace wems;
using namespace wems::identify;
using Complex = std::complex<double>;

namespace {

/// y_k = x_k − 0.5 x_{k−1} + 0.25 x_{k−2}, with noise of these sizes on x and y.
Eigen::MatrixXd makeSignals(std::mt19937& generator, int n, double input_noise, double output_noise) {
    std::normal_distribution<double> normal;
    Eigen::VectorXd x(n);
    for (double& value : x) value = normal(generator);
    Eigen::MatrixXd signals(n, 2);
    for (int k = 0; k < n; ++k) {
        signals(k, 0) = x[k] + input_noise * normal(generator);
        signals(k, 1) =
            x[k] - (k > 0 ? 0.5 * x[k - 1] : 0) + (k > 1 ? 0.25 * x[k - 2] : 0) + output_noise * normal(generator);
    }
    return signals;
}

Complex trueTransfer(double f) {
    const Complex z = std::polar(1.0, -kTwoPi * f);
    return 1.0 - 0.5 * z + 0.25 * z * z;
}

}  // namespace

TEST_CASE("without noise all three estimates are the system") {
    std::mt19937 generator(1);
    const CrossSpectra spectra = estimateSpectra(makeSignals(generator, 20000, 0, 0), 0, 1, {512});
    const TransferEstimate estimate = estimateTransfer(spectra, 1);
    for (Eigen::Index k = 3; k < 254; k += 10) {
        const Complex H = trueTransfer(spectra.frequency[k]);
        // A segment sees its ends cut: of the order of the filter's length over the segment's, by both windows.
        CHECK(std::abs(estimate.h1[k] - H) < 0.01);
        CHECK(std::abs(estimate.h2[k] - H) < 0.01);
        CHECK(std::abs(estimate.hv[k] - H) < 0.01);
        CHECK(estimate.coherence[k] > 0.999);
    }
}

TEST_CASE("noise on the input biases H1, noise on the output H2, Hv lies between") {
    std::mt19937 generator(2);
    // Input noise 0.5: S_xx is 1.25 of the true one.
    const CrossSpectra in = estimateSpectra(makeSignals(generator, 200000, 0.5, 0), 0, 1, {128});
    const CrossSpectra out = estimateSpectra(makeSignals(generator, 200000, 0, 0.5), 0, 1, {128});
    const TransferEstimate noisy_in = estimateTransfer(in, 1), noisy_out = estimateTransfer(out, 1);
    for (const Eigen::Index k : {10, 25, 50}) {
        const Complex H = trueTransfer(in.frequency[k]);
        CHECK(std::abs(noisy_in.h1[k] - H / 1.25) < 0.05 * std::abs(H));
        CHECK(std::abs(noisy_in.h2[k] - H) < 0.05 * std::abs(H));
        CHECK(std::abs(noisy_in.hv[k] - H / std::sqrt(1.25)) < 0.05 * std::abs(H));
        CHECK(std::abs(noisy_out.h1[k] - H) < 0.05 * std::abs(H));
        CHECK(std::abs(noisy_out.h2[k] - H * (1 + 0.25 / std::norm(H))) < 0.05 * std::abs(H));
        CHECK(noisy_in.coherence[k] == Approx(1 / 1.25).margin(0.03));
    }
}

TEST_CASE("95 % circles hold the true transfer function in about 95 % of cases") {
    const auto seed = GENERATE(3u, 4u);
    CAPTURE(seed);
    std::mt19937 generator(seed);
    int inside = 0, all = 0, coherent = 0;
    for (int run = 0; run < 100; ++run) {
        const Eigen::MatrixXd signals = makeSignals(generator, 2000, 0, 0.7);
        const CrossSpectra spectra = estimateSpectra(signals, 0, 1, {128});
        const TransferEstimate estimate = estimateTransfer(spectra, 1);
        std::normal_distribution<double> normal;
        Eigen::MatrixXd unrelated = signals;
        for (double& value : unrelated.col(1)) value = normal(generator);
        const TransferEstimate nothing = estimateTransfer(estimateSpectra(unrelated, 0, 1, {128}), 1);
        for (Eigen::Index k = 4; k < 62; k += 4) {
            inside += std::abs(estimate.h1[k] - trueTransfer(spectra.frequency[k])) < estimate.radius95[k];
            coherent += nothing.coherence[k] > coherenceThreshold95(spectra.degrees_of_freedom);
            ++all;
        }
    }
    // 1500 cases of 95 %: standard deviation 0.6 %. The number of degrees of freedom of overlapping segments is one for
    // the density, near it for the cross density: 2 % are allowed for that, and four standard deviations. Real degrees
    // of freedom taken for complex ones make circles narrower by √2, which hold 78 %: never within these limits.
    CHECK(inside / double(all) == Approx(0.95).margin(0.045));
    CHECK(coherent / double(all) == Approx(0.05).margin(0.045));
}
