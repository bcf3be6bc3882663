#include "identify/motion/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <vector>

#include "identify/motion/fftw_plan.hpp"
#include "models/pi.hpp"

namespace wems::identify {
namespace {

using Complex = std::complex<double>;

std::size_t nextPowerOfTwo(std::size_t n) {
    std::size_t power = 1;
    while (power < n) power *= 2;
    return power;
}

// Periods of the lowest frequency over which the high pass rings.
constexpr double ringing_periods = 8;

/// Gain of the high pass: from 0 at 2/3 of `lowest` to 1 there as a raised cosine.
double calcHighPassGain(double frequency, double lowest) {
    const double ramp = std::clamp((frequency / lowest - 2.0 / 3) * 3, 0.0, 1.0);
    return 0.5 - 0.5 * std::cos(kPi * ramp);
}

}  // namespace

Spectrum calcSpectrum(const Eigen::VectorXd& signal, double interval, int segment) {
    const std::size_t samples = signal.size();
    const std::size_t length = std::min<std::size_t>(segment, nextPowerOfTwo(samples + 1) / 2);
    std::vector<double> block(length), window(length);
    double window_power = 0;
    for (std::size_t i = 0; i < length; ++i) {
        window[i] = 0.5 - 0.5 * std::cos(kTwoPi * (static_cast<double>(i) + 0.5) / static_cast<double>(length));
        window_power += window[i] * window[i];
    }
    const Eigen::Index bins = length / 2 + 1;
    std::vector<Complex> transform(length / 2 + 1);
    const FftwPlan plan(
        fftw_plan_dft_r2c_1d(static_cast<int>(length), block.data(), asFftw(transform.data()), FFTW_ESTIMATE));
    Spectrum spectrum;
    spectrum.frequency = Eigen::VectorXd::LinSpaced(bins, 0, 0.5 / interval);
    spectrum.density = Eigen::VectorXd::Zero(bins);
    int count = 0;
    for (std::size_t start = 0; start + length <= samples; start += std::max<std::size_t>(1, length / 2), ++count) {
        double mean = 0;
        for (std::size_t i = 0; i < length; ++i) mean += signal[start + i] / static_cast<double>(length);
        for (std::size_t i = 0; i < length; ++i) block[i] = window[i] * (signal[start + i] - mean);
        fftw_execute(plan.get());
        for (Eigen::Index i = 0; i < bins; ++i) spectrum.density[i] += std::norm(transform[i]);
    }
    spectrum.density *= 2 * interval / (window_power * count);
    return spectrum;
}

IntegratedSignal integrateTwice(const Eigen::VectorXd& acceleration, double interval, double lowest) {
    const std::size_t samples = acceleration.size();
    // Padding long enough for what the high pass rings to die out before it wraps around.
    const std::size_t length =
        nextPowerOfTwo(samples + static_cast<std::size_t>(std::min(ringing_periods / (lowest * interval),
                                                                   4.0 * static_cast<double>(samples))));
    std::vector<double> signal(length, 0.0);
    std::copy(acceleration.data(), acceleration.data() + samples, signal.begin());
    std::vector<Complex> transform(length / 2 + 1), product(length / 2 + 1);
    const FftwPlan forward(
        fftw_plan_dft_r2c_1d(static_cast<int>(length), signal.data(), asFftw(transform.data()), FFTW_ESTIMATE));
    const FftwPlan backward(
        fftw_plan_dft_c2r_1d(static_cast<int>(length), asFftw(product.data()), signal.data(), FFTW_ESTIMATE));
    fftw_execute(forward.get());
    IntegratedSignal result;
    for (const int order : {1, 2}) {
        for (std::size_t i = 0; i < product.size(); ++i) {
            const double f = static_cast<double>(i) / (static_cast<double>(length) * interval);
            const double gain = calcHighPassGain(f, lowest);
            const Complex s(0, kTwoPi * f);
            const Complex factor = gain == 0 ? Complex(0) : (order == 1 ? gain / s : gain / (s * s));
            product[i] = transform[i] * factor / static_cast<double>(length);
        }
        fftw_execute(backward.get());
        (order == 1 ? result.v : result.x) = Eigen::Map<const Eigen::VectorXd>(signal.data(), samples);
    }
    return result;
}

Eigen::VectorXd highPass(const Eigen::VectorXd& signal, double interval, double lowest) {
    const Eigen::Index n = signal.size();
    const Eigen::Index pad = std::min(n - 1, static_cast<Eigen::Index>(ringing_periods / (lowest * interval)));
    const std::size_t length = nextPowerOfTwo(n + 2 * pad);
    const double mean = signal.mean();
    std::vector<double> values(length, 0.0);
    for (Eigen::Index k = 0; k < pad; ++k) {
        values[k] = 2 * signal[0] - signal[pad - k] - mean;
        values[n + pad + k] = 2 * signal[n - 1] - signal[n - 2 - k] - mean;
    }
    for (Eigen::Index k = 0; k < n; ++k) values[pad + k] = signal[k] - mean;
    std::vector<Complex> transform(length / 2 + 1);
    const FftwPlan forward(
        fftw_plan_dft_r2c_1d(static_cast<int>(length), values.data(), asFftw(transform.data()), FFTW_ESTIMATE));
    const FftwPlan backward(
        fftw_plan_dft_c2r_1d(static_cast<int>(length), asFftw(transform.data()), values.data(), FFTW_ESTIMATE));
    fftw_execute(forward.get());
    for (std::size_t i = 0; i < transform.size(); ++i) {
        const double f = static_cast<double>(i) / (static_cast<double>(length) * interval);
        transform[i] *= calcHighPassGain(f, lowest) / static_cast<double>(length);
    }
    fftw_execute(backward.get());
    return Eigen::Map<const Eigen::VectorXd>(values.data() + pad, n);
}

SlowSignal keepSlowPart(const Eigen::VectorXd& signal, double interval, double pass, double stop) {
    const std::size_t samples = signal.size();
    const std::size_t length = nextPowerOfTwo(
        samples + static_cast<std::size_t>(std::min(8 / (pass * interval), 4.0 * static_cast<double>(samples))));
    std::vector<double> buffer(length, 0.0);
    std::copy(signal.data(), signal.data() + samples, buffer.begin());
    std::vector<Complex> transform(length / 2 + 1), product(length / 2 + 1);
    const FftwPlan forward(
        fftw_plan_dft_r2c_1d(static_cast<int>(length), buffer.data(), asFftw(transform.data()), FFTW_ESTIMATE));
    const FftwPlan backward(
        fftw_plan_dft_c2r_1d(static_cast<int>(length), asFftw(product.data()), buffer.data(), FFTW_ESTIMATE));
    fftw_execute(forward.get());
    SlowSignal result;
    for (const bool rate : {false, true}) {
        for (std::size_t i = 0; i < product.size(); ++i) {
            const double f = static_cast<double>(i) / (static_cast<double>(length) * interval);
            const double gain = 0.5 + 0.5 * std::cos(kPi * std::clamp((f - pass) / (stop - pass), 0.0, 1.0));
            product[i] =
                transform[i] * (rate ? Complex(0, kTwoPi * f) : Complex(1)) * gain / static_cast<double>(length);
        }
        fftw_execute(backward.get());
        (rate ? result.rate : result.x) = Eigen::Map<const Eigen::VectorXd>(buffer.data(), samples);
    }
    return result;
}

}  // namespace wems::identify
