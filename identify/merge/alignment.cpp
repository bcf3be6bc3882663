#include "identify/merge/alignment.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>

#include "identify/motion/fftw_plan.hpp"

namespace wems::identify {
namespace {

constexpr int refinements = 6;
constexpr std::size_t least_overlap = 64;  // samples

using Complex = std::complex<double>;

UniformSignal atRate(const UniformSignal& signal, double interval) {
    if (interval <= signal.interval * (1 + 1e-9)) return signal;
    const auto count = static_cast<std::size_t>((signal.end() - signal.start) / interval) + 1;
    return resample(signal, signal.start, interval, count);
}

std::vector<Complex> transform(const std::vector<double>& values, std::size_t length) {
    double mean = 0;
    for (const double v : values) mean += v / static_cast<double>(values.size());
    std::vector<double> padded(length, 0.0);
    for (std::size_t i = 0; i < values.size(); ++i) padded[i] = values[i] - mean;
    std::vector<Complex> result(length / 2 + 1);
    const FftwPlan plan(
        fftw_plan_dft_r2c_1d(static_cast<int>(length), padded.data(), asFftw(result.data()), FFTW_ESTIMATE));
    fftw_execute(plan.get());
    return result;
}

/// Lag l, in samples, that maximises Σ a_k b_{k+l}.
long findLag(const std::vector<double>& a, const std::vector<double>& b) {
    std::size_t length = 1;
    while (length < a.size() + b.size()) length *= 2;
    auto product = transform(b, length);
    const auto other = transform(a, length);
    for (std::size_t i = 0; i < product.size(); ++i) product[i] *= std::conj(other[i]);
    std::vector<double> correlation(length);
    const FftwPlan plan(
        fftw_plan_dft_c2r_1d(static_cast<int>(length), asFftw(product.data()), correlation.data(), FFTW_ESTIMATE));
    fftw_execute(plan.get());
    const auto best =
        static_cast<std::size_t>(std::max_element(correlation.begin(), correlation.end()) - correlation.begin());
    return best < b.size() ? static_cast<long>(best) : static_cast<long>(best) - static_cast<long>(length);
}

/// Gauss–Newton for a(t) = b(t − shift)/gain on samples `from` to `to` of a.
class Refinement {
public:
    Refinement(const UniformSignal& a, const UniformSignal& b, double shift) : a_(a), b_(b) { result_.shift = shift; }

    Alignment solve(double from_share, double to_share) {
        for (int step = 0; step < refinements; ++step) {
            const double from = std::max(a_.start, b_.start + result_.shift);
            const double to = std::min(a_.end(), b_.end() + result_.shift);
            const double first_time = from + from_share * (to - from), last_time = from + to_share * (to - from);
            const auto first = static_cast<std::size_t>(std::ceil((first_time - a_.start) / a_.interval - 1e-9));
            const auto last = static_cast<long>(std::floor((last_time - a_.start) / a_.interval + 1e-9));
            if (last < static_cast<long>(first + least_overlap)) return {};
            const std::size_t count = static_cast<std::size_t>(last) - first + 1;
            const double start = a_.start + static_cast<double>(first) * a_.interval;
            update(resample(b_, start - result_.shift, a_.interval, count).values, first);
        }
        return result_;
    }

private:
    void update(const std::vector<double>& b, std::size_t first) {
        const std::size_t n = b.size();
        double mean_a = 0, mean_b = 0;
        for (std::size_t i = 0; i < n; ++i) {
            mean_a += a_.values[first + i] / static_cast<double>(n);
            mean_b += b[i] / static_cast<double>(n);
        }
        double bb = 0, br = 0, rr = 0, ab = 0, ar = 0, aa = 0;
        for (std::size_t i = 1; i + 1 < n; ++i) {
            const double x = a_.values[first + i] - mean_a, y = b[i] - mean_b;
            const double rate = (b[i + 1] - b[i - 1]) / (2 * a_.interval);
            bb += y * y, br += y * rate, rr += rate * rate, ab += x * y, ar += x * rate, aa += x * x;
        }
        const double determinant = bb * rr - br * br;
        if (!(determinant > 0) || !(aa > 0)) return;
        const double g = (ab * rr - ar * br) / determinant, slope = (ar * bb - ab * br) / determinant;
        const double residual = std::max(0.0, aa - g * ab - slope * ar);
        result_.correlation = ab / std::sqrt(aa * bb);
        if (g == 0) return;
        // a(t) = g b(t − s − δ) = g b − g δ b'.
        const double step = -slope / g;
        result_.shift += std::clamp(step, -2 * a_.interval, 2 * a_.interval);
        result_.gain = 1 / g;
        result_.deviation = std::sqrt(residual / static_cast<double>(n) / rr) / std::abs(g);
    }

    const UniformSignal& a_;
    const UniformSignal& b_;
    Alignment result_;
};

}  // namespace

Alignment align(const UniformSignal& first, const UniformSignal& second) {
    const double interval = std::max(first.interval, second.interval);
    const UniformSignal a = atRate(first, interval), b = atRate(second, interval);
    const UniformSignal same =
        b.interval == a.interval
            ? b
            : resample(b, b.start, interval, static_cast<std::size_t>((b.end() - b.start) / interval) + 1);
    const long lag = findLag(a.values, same.values);
    const double shift = a.start - same.start - static_cast<double>(lag) * interval;
    Alignment result = Refinement(a, same, shift).solve(0, 1);
    const Alignment early = Refinement(a, same, result.shift).solve(0, 1.0 / 3);
    const Alignment late = Refinement(a, same, result.shift).solve(2.0 / 3, 1);
    const double difference = late.shift - early.shift;
    if (early.correlation > 0.5 && late.correlation > 0.5 &&
        std::abs(difference) > 5 * std::hypot(early.deviation, late.deviation) + 1e-3 * interval)
        result.drift = difference;
    return result;
}

}  // namespace wems::identify
