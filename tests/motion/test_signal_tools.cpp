// Medians, derivatives, noise, lines of a spectrum, work on several threads: each against a closed form or a count by
// hand.
#include <tbb/global_control.h>

#include <Eigen/Dense>
#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <stdexcept>

#include "identify/motion/differentiation.hpp"
#include "identify/motion/noise_estimate.hpp"
#include "identify/motion/parallel.hpp"
#include "identify/motion/spectrum.hpp"
#include "models/common/units.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

Eigen::VectorXd sample(int count, double interval, const std::function<double(double)>& f) {
    Eigen::VectorXd values(count);
    for (int k = 0; k < count; ++k) values[k] = f(k * interval);
    return values;
}

}  // namespace

TEST_CASE("median: the upper middle, as sorting finds it") {
    CHECK(median({3}) == 3);
    CHECK(median({4, 1}) == 4);
    CHECK(median({9, -2, 5}) == 5);
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<> normal;
    for (std::size_t count = 1; count < 40; ++count) {
        std::vector<double> values(count);
        for (double& value : values) value = normal(random);
        std::vector<double> sorted = values;
        std::sort(sorted.begin(), sorted.end());
        CHECK(median(values) == sorted[count / 2]);
    }
}

TEST_CASE("differentiate: polynomials of eighth degree exactly inside, of lower degree at the ends") {
    const double h = 0.01;
    const auto derive = [&](int degree) {
        return differentiate(sample(41, h, [&](double t) { return std::pow(t - 0.2, degree); }), h);
    };
    for (int degree = 0; degree <= 8; ++degree) {
        const Derivatives found = derive(degree);
        const double size = degree < 2 ? 1 : degree * (degree - 1) * std::pow(0.2, degree - 2);
        for (int k = 4; k < 37; ++k) {
            CAPTURE(degree, k);
            const double x = k * h - 0.2;
            const double first = degree == 0 ? 0 : degree * std::pow(x, degree - 1);
            const double second = degree < 2 ? 0 : degree * (degree - 1) * std::pow(x, degree - 2);
            CHECK(found.first[k] == Approx(first).margin(1e-9 * size));
            CHECK(found.second[k] == Approx(second).margin(1e-8 * size));
        }
    }
    const Derivatives parabola = derive(2);
    for (int k = 0; k < 41; ++k) {
        CHECK(parabola.first[k] == Approx(2 * (k * h - 0.2)).margin(1e-10));
        CHECK(parabola.second[k] == Approx(2).margin(1e-7));
    }
}

TEST_CASE("smoothZeroPhase: the gain 1/(1 + (f/cutoff)^6), no delay, a straight line as it is") {
    const double h = 1e-3, cutoff = 100;
    for (const double f : {20.0, 50.0, 100.0, 130.0}) {
        const Eigen::VectorXd sine = sample(4001, h, [&](double t) { return std::sin(kTwoPi * f * t); });
        const Eigen::VectorXd smooth = smoothZeroPhase(sine, h, cutoff);
        // The filter is an analogue one's bilinear image: both frequencies are tan(π f h)/(π h).
        const double ratio = std::tan(kPi * f * h) / std::tan(kPi * cutoff * h);
        const double gain = 1 / (1 + std::pow(ratio, 6));
        CAPTURE(f);
        CHECK((smooth - gain * sine).segment(500, 3000).cwiseAbs().maxCoeff() < 2e-3);
    }
    const Eigen::VectorXd line = sample(500, h, [](double t) { return 3 - 7 * t; });
    CHECK((smoothZeroPhase(line, h, cutoff) - line).cwiseAbs().maxCoeff() < 1e-6);  // how the filter starts
}

TEST_CASE("findAccelerationEnd: nine tenths of the acceleration, not of the displacement nor of the noise") {
    const double h = 1e-3;
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<> normal;
    // Of the accelerations' power 1 : ratio lies at 20 and 160 Hz, of the displacements' 4096 : ratio.
    const double ratio = GENERATE(0.05, 0.5);
    Eigen::MatrixXd signals(1, 30000);
    signals.row(0) = sample(30000, h, [&](double t) {
                         return std::sin(kTwoPi * 20 * t) + std::sqrt(ratio) / 64 * std::sin(kTwoPi * 160 * t) +
                                1e-4 * normal(random);
                     }).transpose();
    CHECK(findAccelerationEnd(signals, h) == Approx(ratio < 1.0 / 9 ? 20 : 160).margin(1));
    CHECK(findAccelerationEnd(Eigen::MatrixXd::Zero(2, 5000), h) == 0);
}

TEST_CASE("findCutoff: above the signal, below where only noise is") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<> noise(0, 1e-3);
    const double h = 1e-3;
    Eigen::MatrixXd signals(2, 8000);
    for (Eigen::Index k = 0; k < signals.cols(); ++k) {
        const double t = static_cast<double>(k) * h;
        signals(0, k) = std::sin(kTwoPi * 30 * t) + noise(random);
        signals(1, k) = std::sin(kTwoPi * 80 * t) + noise(random);
    }
    const double cutoff = findCutoff(signals, h);
    CHECK(cutoff > 80);
    CHECK(cutoff <= 250);
}

TEST_CASE("noise from residuals and from a signal alone: the level that was drawn") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    const double sigma = 0.3;
    std::normal_distribution<> noise(0, sigma);
    const int count = 20000;
    SECTION("nine channels of which six are explained") {
        Eigen::MatrixXd channels(9, count);
        for (double& value : channels.reshaped()) value = noise(random);
        // Residuals of any fit with six unknowns: the projection on three orthonormal directions.
        const Eigen::MatrixXd q =
            Eigen::HouseholderQR<Eigen::MatrixXd>(Eigen::MatrixXd::Random(9, 9).eval()).householderQ();
        const Eigen::MatrixXd outside = q.leftCols(3) * q.leftCols(3).transpose();
        // The median of 20 000 values of χ²(3) errs by 0.7 %; five times that, and differences overlap.
        CHECK(estimateNoiseFromResiduals(outside * channels, 3) == Approx(sigma).epsilon(0.05));
        // A burst in a tenth of the samples hardly counts.
        channels.leftCols(count / 10) *= 20;
        CHECK(estimateNoiseFromResiduals(outside * channels, 3) == Approx(sigma).epsilon(0.2));
    }
    SECTION("a slow motion a thousand times larger") {
        Eigen::VectorXd signal = sample(count, 1e-3, [](double t) { return 300 * std::sin(kTwoPi * 5 * t); });
        for (double& value : signal) value += noise(random);
        CHECK(estimateNoiseFromSignal(signal) == Approx(sigma).epsilon(0.1));
    }
}

TEST_CASE("findTones: the lines of a sum of sines, none in one sine or a sweep") {
    const double h = 1e-3;
    const auto sines = [&](const std::vector<double>& frequencies) {
        return sample(8000, h, [&](double t) {
            double sum = 0;
            for (const double f : frequencies) sum += std::sin(kTwoPi * f * t + f);
            return sum;
        });
    };
    for (const std::vector<double>& wanted : {std::vector<double>{11, 17.3}, {7.7, 19.1, 31.9, 47.3}}) {
        const auto found = findTones(sines(wanted), h, 100, true);
        REQUIRE(found.size() == wanted.size());
        for (std::size_t i = 0; i < wanted.size(); ++i) CHECK(found[i] == Approx(wanted[i]).margin(0.03));
    }
    CHECK(findTones(sines({23.4}), h, 100, true).empty());
    CHECK(findTones(sines({10, 20, 30}), h, 100, false).empty());
    const Eigen::VectorXd sweep = sample(8000, h, [](double t) { return std::sin(kTwoPi * (5 * t + 2.5 * t * t)); });
    CHECK(findTones(sweep, h, 100, true).empty());
}

TEST_CASE("findTones: a line that stops early counts as long as half of the powers overlap in time") {
    const double h = 1e-3;
    for (const double share : {0.4, 0.6}) {
        // Constant powers: their overlap is the share of the time that the shorter one lasts.
        const Eigen::VectorXd signal = sample(16000, h, [&](double t) {
            return std::sin(kTwoPi * 11 * t) + (t < 16 * share ? std::sin(kTwoPi * 17.3 * t) : 0);
        });
        CAPTURE(share);
        CHECK(findTones(signal, h, 100, true).size() == (share > 0.5 ? 2 : 0));
    }
}

TEST_CASE("integrateTwice: a pulse at the end does not ring at the beginning") {
    // Before the pulse the high pass rings, after it, too: with less than eight periods of 5 Hz behind the recording
    // that would come back at its beginning. Five, up to the next power of two, would leave 0.5 % of the peak there.
    const double h = 1e-3, lowest = 5;
    Eigen::VectorXd pulse = Eigen::VectorXd::Zero(8192 - 1000);
    for (int k = 0; k < 100; ++k) pulse[pulse.size() - 100 + k] = std::pow(std::sin(kPi * k / 100), 2);
    Eigen::VectorXd longer = Eigen::VectorXd::Zero(200000);
    longer.head(pulse.size()) = pulse;
    const Eigen::VectorXd x = integrateTwice(pulse, h, lowest).x;
    const Eigen::VectorXd expected = integrateTwice(longer, h, lowest).x.head(pulse.size());
    CHECK((x - expected).head(2000).cwiseAbs().maxCoeff() < 2e-4 * expected.cwiseAbs().maxCoeff());
}

TEST_CASE("runParallel: each piece once, and what one throws comes out") {
    for (const std::size_t count : {0U, 1U, 2U, 1000U}) {
        std::vector<std::atomic<int>> done(count);
        runParallel(count, [&](std::size_t i) { ++done[i]; });
        CHECK(std::all_of(done.begin(), done.end(), [](const auto& times) { return times == 1; }));
    }
    std::atomic<int> called = 0;
    const auto failAtSeven = [&called] {
        runParallel(100000, [&called](std::size_t i) {
            ++called;
            if (i == 7) throw std::runtime_error("piece 7");
        });
    };
    CHECK_THROWS_WITH(failAtSeven(), "piece 7");
    // On one thread nothing can begin while a piece fails; on several a busy machine may let all the others end first.
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    called = 0;
    CHECK_THROWS_WITH(failAtSeven(), "piece 7");
    CHECK(called < 100000);
}
