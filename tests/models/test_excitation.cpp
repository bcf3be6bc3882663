#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <functional>
#include <memory>
#include <vector>

#include "models/common/error.hpp"
#include "models/common/units.hpp"
#include "models/excitation.hpp"

using namespace wems;

TEST_CASE("sweeps: the phase is the integral of the frequency, which runs from f0 to f1") {
    const auto make = GENERATE(values<std::function<std::unique_ptr<Signal>()>>({
        [] { return makeLogarithmicSweep(5, 50, 4); },
        [] { return makeLogarithmicSweep(50, 5, 4); },
        [] { return makeLinearSweep(5, 50, 0.9); },
        [] { return makeLinearSweep(50, 5, 0.9); },
        [] { return makeDwell(17, 3); },
    }));
    const auto signal = make();
    const double T = signal->duration();
    const int steps = 20000;
    double phase = 0;  // Simpson's rule
    for (int i = 0; i < steps; ++i) {
        const double a = T * i / steps, b = T * (i + 1) / steps;
        phase +=
            kTwoPi * (b - a) / 6 * (signal->frequency(a) + 4 * signal->frequency((a + b) / 2) + signal->frequency(b));
        if (i % 1000 == 0) {
            CHECK(signal->phase(b) == Approx(phase).margin(1e-7));
            CHECK(signal->value(b) == Approx(std::sin(phase)).margin(1e-6));
        }
    }
    CHECK(signal->value(-1e-9) == 0);
    CHECK(signal->value(T + 1e-9) == 0);
}

TEST_CASE("logarithmic sweep: rate in octaves per minute") {
    const auto up = makeLogarithmicSweep(5, 50, 4), down = makeLogarithmicSweep(50, 5, 4);
    CHECK(up->duration() == Approx(60 * std::log2(10.0) / 4));
    CHECK(up->frequency(15) == Approx(10));
    CHECK(up->frequency(up->duration()) == Approx(50));
    CHECK(down->frequency(15) == Approx(25));
    CHECK(down->frequency(down->duration()) == Approx(5));
}

TEST_CASE("fades rise and fall as raised cosines") {
    const auto plain = makeDwell(40, 2), faded = makeDwell(40, 2, {0.5, 0.25});
    CHECK(faded->value(0.25 + 1e-3) / plain->value(0.25 + 1e-3) == Approx(0.5 * (1 - std::cos(kPi * 0.502))));
    CHECK(faded->value(1.003) == plain->value(1.003));
    CHECK(faded->value(1.9) / plain->value(1.9 + 0) == Approx(0.5 * (1 - std::cos(kPi * 0.4))));
    CHECK_THROWS_AS(makeDwell(40, 2, {1.5, 0.6}), InputError);
    CHECK_THROWS_AS(makeDwell(40, 2, {-0.1, 0}), InputError);
}

TEST_CASE("half sine: its spectrum and its velocity step are the analytic ones, then there is rest") {
    const double T = 0.011, rest = 0.2;
    const auto signal = makeHalfSine(T, rest);
    CHECK(signal->duration() == Approx(T + rest));
    // ∫ sin(π t / T) exp(−i ω t) dt = (π / T) (1 + exp(−i ω T)) / ((π / T)² − ω²), by Simpson's rule.
    for (const double f : {0.0, 7.0, 40.0, 100.0, 333.0}) {
        const int steps = 2000;
        const double h = T / steps, w = kTwoPi * f, p = kPi / T;
        std::complex<double> spectrum = 0;
        for (int i = 0; i <= steps; ++i) {
            const double weight = i == 0 || i == steps ? 1 : i % 2 == 0 ? 2 : 4;
            spectrum += weight * h / 3 * signal->value(h * i) * std::polar(1.0, -w * h * i);
        }
        const std::complex<double> expected = p * (1.0 + std::polar(1.0, -w * T)) / (p * p - w * w);
        CAPTURE(f);
        CHECK(std::abs(spectrum - expected) < 1e-9 * T);
    }
    CHECK(signal->value(T / 2) == Approx(1));
    CHECK(signal->frequency(T / 3) == Approx(1 / (2 * T)));
    for (const double t : {-1e-9, T, T + 1e-3, T + rest, T + rest + 1e-9}) CHECK(signal->value(t) == 0);
}

TEST_CASE("random: unit RMS, inside its band, the same for the same seed only") {
    const double T = 8, rate = 512;
    const auto signal = makeBandLimitedRandom(10, 40, T, 42), same = makeBandLimitedRandom(10, 40, T, 42),
               other = makeBandLimitedRandom(10, 40, T, 43);
    const int n = static_cast<int>(T * rate);
    std::vector<double> samples;
    double squares = 0, difference = 0, product = 0;
    for (int i = 0; i < n; ++i) {
        const double x = signal->value(i / rate), y = other->value(i / rate);
        samples.push_back(x);
        squares += x * x;
        difference += std::abs(x - same->value(i / rate));
        product += x * y;
    }
    CHECK(std::sqrt(squares / n) == Approx(1).epsilon(1e-3));
    CHECK(difference == 0);
    CHECK(std::abs(product / n) < 0.3);
    // All power lies at multiples of 1/T inside the band (discrete Fourier sums).
    const auto power = [&](double f) {
        std::complex<double> sum = 0;
        for (int i = 0; i < n; ++i) sum += samples[i] * std::polar(1.0, -kTwoPi * f * i / rate);
        return std::norm(sum / double(n));
    };
    double inside = 0, outside = 0;
    for (int k = 1; k < 80; ++k) outside += power(k / T);
    for (int k = 80; k <= 320; ++k) inside += power(k / T);
    for (int k = 321; k < 480; ++k) outside += power(k / T);
    CHECK(2 * inside == Approx(1).epsilon(1e-3));
    CHECK(outside < 1e-6);
}

TEST_CASE("excitation that makes no sense is refused") {
    CHECK_THROWS_AS(makeLogarithmicSweep(0, 50, 4), InputError);
    CHECK_THROWS_AS(makeLogarithmicSweep(5, -50, 4), InputError);
    CHECK_THROWS_AS(makeLogarithmicSweep(5, 50, 0), InputError);
    CHECK_THROWS_AS(makeLogarithmicSweep(5, 5, 4), InputError);
    CHECK_THROWS_AS(makeLinearSweep(5, NAN, 4), InputError);
    CHECK_THROWS_AS(makeDwell(5, 0), InputError);
    CHECK_THROWS_AS(makeHalfSine(0, 1), InputError);
    CHECK_THROWS_AS(makeHalfSine(0.01, -1), InputError);
    CHECK_THROWS_AS(makeBandLimitedRandom(50, 5, 10, 1), InputError);
    CHECK_THROWS_AS(makeBandLimitedRandom(5.1, 5.2, 1, 1), InputError);
}

TEST_CASE(
    "random by a spectrum: its periodogram is the spectrum, its RMS the spectrum's, between rows a sum of sines") {
    const PowerSpectrum spectrum({20, 50, 130.3}, {0.5, 2, 0.7}, Quantity::acceleration);
    const double T = 4;
    const auto signal = makeRandomFromSpectrum(spectrum, T, 11);
    const auto again = makeRandomFromSpectrum(spectrum, T, 11), other = makeRandomFromSpectrum(spectrum, T, 12);
    CHECK(signal->duration() == T);
    CHECK(signal->highestFrequency() == 130.3);
    const int n = 2048;  // 512 Hz
    std::vector<double> samples;
    for (int k = 0; k < n; ++k) samples.push_back(signal->value(k * T / n));
    double square = 0;
    for (const double value : samples) square += value * value / n;
    CHECK(std::sqrt(square) == Approx(spectrum.calcRms()).epsilon(1e-6));
    // Slow DFT: each line holds what the spectrum has within 1/T, nothing elsewhere.
    const auto findLine = [&](int line) {
        std::complex<double> sum = 0;
        for (int k = 0; k < n; ++k) sum += samples[std::size_t(k)] * std::polar(1.0, -kTwoPi * line * k / n);
        return sum / double(n);
    };
    std::vector<std::complex<double>> lines;
    for (int line = 0; line < n / 2; ++line) lines.push_back(findLine(line));
    for (int line = 1; line < n / 2; ++line) {
        double expected = spectrum.calcMeanSquare((line - 0.5) / T, (line + 0.5) / T);
        if (line < 80 || line > 521) expected = 0;
        if (line == 80) expected = spectrum.calcMeanSquare(20, 80.5 / T);
        if (line == 521) expected = spectrum.calcMeanSquare(520.5 / T, 130.3);
        CAPTURE(line);
        CHECK(2 * std::norm(lines[std::size_t(line)]) == Approx(expected).epsilon(1e-5).margin(1e-12));
    }
    for (const double t : {0.00031, 0.7, 1.2345, 3.9991}) {
        double sum = 0;
        for (int line = 1; line < n / 2; ++line)
            sum += 2 * (lines[std::size_t(line)] * std::polar(1.0, kTwoPi * line * t / T)).real();
        CHECK(signal->value(t) == Approx(sum).margin(1e-6));
        CHECK(again->value(t) == signal->value(t));
        CHECK(other->value(t) != signal->value(t));
    }
    CHECK_THROWS_AS(makeRandomFromSpectrum(spectrum, 0.01, 1), InputError);
    CHECK_THROWS_AS(makeRandomFromSpectrum(spectrum, 1e6, 1), InputError);
}

TEST_CASE("integrals at the start of a sum of sines leave no drift") {
    const PowerSpectrum spectrum({20, 80}, {1, 1}, Quantity::acceleration);
    std::vector<std::unique_ptr<Signal>> signals;
    signals.push_back(makeDwell(5, 2));
    signals.push_back(makeBandLimitedRandom(4, 40, 2, 3));
    signals.push_back(makeRandomFromSpectrum(spectrum, 2, 5));
    for (const auto& signal : signals) {
        const auto start = signal->integralsAtStart();
        REQUIRE(start);
        // Simpson's rule over the duration, a multiple of every period: both integrals come back to where they began.
        const int steps = 40000;
        const double h = signal->duration() / steps;
        double v = start->first, x = start->second, mean = 0;
        for (int k = 0; k < steps; ++k) {
            const double a = signal->value(k * h), b = signal->value((k + 0.5) * h), c = signal->value((k + 1) * h);
            mean += x / steps;
            x += h * v + h * h / 6 * (a + 2 * b);
            v += h / 6 * (a + 4 * b + c);
        }
        CHECK(v == Approx(start->first).margin(1e-7));
        CHECK(x == Approx(start->second).margin(1e-7));
        CHECK(std::abs(mean) < 1e-7);
        CHECK_FALSE(makeDwell(5, 2, {0.1, 0.1})->integralsAtStart());
    }
    CHECK_FALSE(makeLogarithmicSweep(5, 50, 4)->integralsAtStart());
}
