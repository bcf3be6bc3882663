#include "identify/motion/spectrum.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "identify/motion/real_transform.hpp"
#include "models/common/units.hpp"

namespace wems::identify {

namespace {

using Complex = std::complex<double>;

Eigen::Index nextPowerOfTwo(Eigen::Index n) {
    Eigen::Index power = 1;
    while (power < n) power *= 2;
    return power;
}

// Periods of the lowest frequency over which the high pass rings.
constexpr double ringing_periods = 8;

}  // namespace

Spectrum calcSpectrum(const Eigen::VectorXd& signal, double interval, int segment) {
    const Eigen::Index samples = signal.size();
    const Eigen::Index length = std::min<Eigen::Index>(segment, nextPowerOfTwo(samples + 1) / 2);
    Eigen::VectorXd window(length);
    for (Eigen::Index i = 0; i < length; ++i)
        window[i] = 0.5 - 0.5 * std::cos(kTwoPi * (static_cast<double>(i) + 0.5) / static_cast<double>(length));
    const RealTransform transform(length);
    Spectrum spectrum;
    spectrum.frequency = Eigen::VectorXd::LinSpaced(transform.binCount(), 0, 0.5 / interval);
    spectrum.density = Eigen::VectorXd::Zero(transform.binCount());
    int count = 0;
    for (Eigen::Index start = 0; start + length <= samples; start += std::max<Eigen::Index>(1, length / 2), ++count) {
        const auto part = signal.segment(start, length);
        spectrum.density += transform.forward(window.cwiseProduct((part.array() - part.mean()).matrix())).cwiseAbs2();
    }
    spectrum.density *= 2 * interval / (window.squaredNorm() * count);
    return spectrum;
}

Eigen::VectorXd calcUnsharedDensity(const Eigen::MatrixXd& channels, double interval,
                                    const Eigen::VectorXd& frequency) {
    constexpr Eigen::Index motions = 6;
    constexpr double third_octave = 1.26;
    const Eigen::Index samples = channels.rows(), count = channels.cols();
    Eigen::VectorXd density = Eigen::VectorXd::Zero(frequency.size());
    if (count <= motions || samples < 2) return density;
    Eigen::VectorXd window(samples);
    for (Eigen::Index i = 0; i < samples; ++i)
        window[i] = 0.5 - 0.5 * std::cos(kTwoPi * (static_cast<double>(i) + 0.5) / static_cast<double>(samples));
    const RealTransform transform(samples);
    Eigen::MatrixXcd bins(count, transform.binCount());
    for (Eigen::Index c = 0; c < count; ++c)
        bins.row(c) =
            transform.forward(window.cwiseProduct((channels.col(c).array() - channels.col(c).mean()).matrix()));
    const double scale = 2 * interval / window.squaredNorm(), width = 1 / (static_cast<double>(samples) * interval);
    Eigen::Index at = 0;
    for (Eigen::Index first = 3; first + 2 * count <= bins.cols();) {  // the window spreads the mean over three bins
        const auto octave = static_cast<Eigen::Index>(third_octave * static_cast<double>(first));
        const Eigen::Index last = std::min(bins.cols(), std::max(first + 2 * count, octave));
        const auto stretch = bins.middleCols(first, last - first);
        const Eigen::MatrixXcd cross = stretch * stretch.adjoint() * (scale / static_cast<double>(last - first));
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd> solver(cross, Eigen::EigenvaluesOnly);
        const double noise = static_cast<double>(count) * solver.eigenvalues().head(count - motions).mean();
        const double centre = 0.5 * width * static_cast<double>(first + last), end = width * static_cast<double>(last);
        for (; at < frequency.size() && frequency[at] < end; ++at)
            density[at] = noise * (first == 3 && frequency[at] > 0 ? std::max(1.0, centre / frequency[at]) : 1.0);
        first = last;
    }
    return density;
}

double calcHighPassGain(double frequency, double lowest) {
    const double ramp = std::clamp((frequency / lowest - 2.0 / 3) * 3, 0.0, 1.0);
    return 0.5 - 0.5 * std::cos(kPi * ramp);
}

IntegratedSignal integrateTwice(const Eigen::VectorXd& acceleration, double interval, double lowest) {
    const Eigen::Index samples = acceleration.size();
    // Padding long enough for what the high pass rings to die out before it wraps around.
    const RealTransform transform(
        nextPowerOfTwo(samples + static_cast<Eigen::Index>(std::min(ringing_periods / (lowest * interval),
                                                                    4.0 * static_cast<double>(samples)))));
    Eigen::VectorXcd bins = transform.forward(acceleration);
    IntegratedSignal result;
    for (Eigen::VectorXd* integral : {&result.v, &result.x}) {
        for (Eigen::Index i = 0; i < bins.size(); ++i) {
            const double f = static_cast<double>(i) / (static_cast<double>(transform.length()) * interval);
            const double gain = integral == &result.v ? calcHighPassGain(f, lowest) : 1;
            bins[i] = f > 0 ? bins[i] * gain / Complex(0, kTwoPi * f) : Complex(0);
        }
        *integral = transform.inverse(bins).head(samples);
    }
    return result;
}

Eigen::VectorXd highPass(const Eigen::VectorXd& signal, double interval, double lowest) {
    const Eigen::Index n = signal.size();
    const Eigen::Index pad = std::min(n - 1, static_cast<Eigen::Index>(ringing_periods / (lowest * interval)));
    const RealTransform transform(nextPowerOfTwo(n + 2 * pad));
    const double mean = signal.mean();
    Eigen::VectorXd values = Eigen::VectorXd::Zero(transform.length());
    for (Eigen::Index k = 0; k < pad; ++k) {
        values[k] = 2 * signal[0] - signal[pad - k] - mean;
        values[n + pad + k] = 2 * signal[n - 1] - signal[n - 2 - k] - mean;
    }
    for (Eigen::Index k = 0; k < n; ++k) values[pad + k] = signal[k] - mean;
    Eigen::VectorXcd bins = transform.forward(values);
    for (Eigen::Index i = 0; i < bins.size(); ++i)
        bins[i] *=
            calcHighPassGain(static_cast<double>(i) / (static_cast<double>(transform.length()) * interval), lowest);
    return transform.inverse(bins).segment(pad, n);
}

SlowSignal keepSlowPart(const Eigen::VectorXd& signal, double interval, double pass, double stop) {
    const Eigen::Index samples = signal.size();
    const RealTransform transform(nextPowerOfTwo(
        samples + static_cast<Eigen::Index>(std::min(8 / (pass * interval), 4.0 * static_cast<double>(samples)))));
    Eigen::VectorXcd slow = transform.forward(signal), rate(transform.binCount());
    for (Eigen::Index i = 0; i < slow.size(); ++i) {
        const double f = static_cast<double>(i) / (static_cast<double>(transform.length()) * interval);
        slow[i] *= 0.5 + 0.5 * std::cos(kPi * std::clamp((f - pass) / (stop - pass), 0.0, 1.0));
        rate[i] = slow[i] * Complex(0, kTwoPi * f);
    }
    return {transform.inverse(slow).head(samples), transform.inverse(rate).head(samples)};
}

namespace {

constexpr double samples_per_period = 64;  // kept of a long recording; a response may hold more than its band
constexpr Eigen::Index few_samples = Eigen::Index{1} << 18;  // none of so few are left out
constexpr Eigen::Index most_samples = Eigen::Index{1} << 20;
constexpr double least_density = 0.01;        // of the mean weighted by power, within an island
constexpr double least_power = 0.04;          // of the strongest island's
constexpr double least_share = 0.7;           // of the power in lines
constexpr double least_concentration = 0.6;   // of an island's power near its peak
constexpr double least_common_share = 0.5;    // of powers over time
constexpr double half_lobe = 3;               // 1/s times the duration; Hann's main lobe ends at 2
constexpr double harmonic_tolerance = 0.003;  // relative
constexpr std::size_t most_tones = 12;
constexpr Eigen::Index time_segments = 32;

/// Means of consecutive samples where there are many: samples_per_period are left, at most most_samples from the
/// middle.
Eigen::VectorXd thinOut(const Eigen::VectorXd& signal, double& interval, double highest) {
    const double ratio = std::min(1 / (samples_per_period * highest * interval),
                                  static_cast<double>(signal.size()) / static_cast<double>(few_samples));
    const auto factor = static_cast<Eigen::Index>(std::max(ratio, 1.0));
    const Eigen::Index count = signal.size() / factor, used = std::min(count, most_samples);
    const Eigen::Index first = (count - used) / 2;
    Eigen::VectorXd thin(used);
    for (Eigen::Index i = 0; i < used; ++i) thin[i] = signal.segment((first + i) * factor, factor).mean();
    interval *= static_cast<double>(factor);
    return thin;
}

struct Island {
    Eigen::Index first = 0, last = 0;  // bins
    double power = 0, lobe = 0;        // all of it, and near its peak
    double frequency = 0;              // Hz
};

/// The signal under a Hann window, as a spectrum that is finer than its duration resolves.
class LineSpectrum {
public:
    LineSpectrum(const Eigen::VectorXd& signal, double interval)
        : samples_(signal.size()), transform_(nextPowerOfTwo(samples_)) {
        Eigen::VectorXd windowed(samples_);
        const double mean = signal.mean();
        for (Eigen::Index i = 0; i < samples_; ++i) {
            const double phase = kTwoPi * (static_cast<double>(i) + 0.5) / static_cast<double>(samples_);
            windowed[i] = (0.5 - 0.5 * std::cos(phase)) * (signal[i] - mean);
        }
        bins_ = transform_.forward(windowed);
        const auto length = static_cast<double>(transform_.length());
        bin_ = 1 / (length * interval);
        lobe_ = static_cast<Eigen::Index>(std::ceil(half_lobe * length / static_cast<double>(samples_)));
        power_ = bins_.cwiseAbs2();
        power_.head(std::min(lobe_, power_.size())).setZero();
    }

    double totalPower() const { return power_.sum(); }

    std::vector<Island> findIslands() const {
        std::vector<Island> islands;
        const double limit = least_density * power_.squaredNorm() / power_.sum();
        for (Eigen::Index i = 0; i < power_.size(); ++i) {
            if (!(power_[i] > limit)) continue;
            if (islands.empty() || i - islands.back().last > lobe_) islands.push_back({i, i, 0, 0, 0});
            islands.back().last = i;
        }
        for (Island& island : islands) measure(island);
        return islands;
    }

    /// Power of an island in each part of the duration, the sum being 1.
    Eigen::VectorXd calcPowerOverTime(const Island& island) const {
        const Eigen::Index first = std::max<Eigen::Index>(0, island.first - lobe_);
        const Eigen::Index count = std::min(power_.size() - 1, island.last + lobe_) + 1 - first;
        Eigen::VectorXcd part = Eigen::VectorXcd::Zero(bins_.size());
        part.segment(first, count) = bins_.segment(first, count);
        const Eigen::VectorXd values = transform_.inverse(part);
        Eigen::VectorXd power = Eigen::VectorXd::Zero(time_segments);
        for (Eigen::Index i = 0; i < samples_; ++i) {
            const double value = values[i];
            power[i * time_segments / samples_] += value * value;
        }
        return power / power.sum();
    }

private:
    void measure(Island& island) const {
        const Eigen::Index bins = island.last - island.first + 1;
        const auto powers = power_.segment(island.first, bins);
        Eigen::Index peak = 0;
        powers.maxCoeff(&peak);
        const Eigen::Index first = std::max<Eigen::Index>(0, peak - lobe_);
        const auto near = powers.segment(first, std::min(bins, peak + lobe_ + 1) - first);
        island.power = powers.sum();
        island.lobe = near.sum();
        const auto positions = Eigen::VectorXd::LinSpaced(near.size(), 0, static_cast<double>(near.size() - 1));
        island.frequency = bin_ * (static_cast<double>(island.first + first) + near.dot(positions) / island.lobe);
    }

    Eigen::Index samples_;
    RealTransform transform_;
    Eigen::VectorXcd bins_;
    Eigen::VectorXd power_;
    double bin_ = 0;         // Hz
    Eigen::Index lobe_ = 0;  // bins, half the width of a line
};

bool areHarmonics(const std::vector<double>& frequencies) {
    return std::all_of(frequencies.begin(), frequencies.end(), [&](double frequency) {
        const double order = frequency / frequencies.front();
        return std::abs(order - std::round(order)) < harmonic_tolerance * order;
    });
}

}  // namespace

std::vector<double> findTones(const Eigen::VectorXd& signal, double interval, double highest, bool harmonics_count) {
    const Eigen::VectorXd thin = thinOut(signal, interval, highest);
    if (thin.size() < time_segments) return {};
    const LineSpectrum spectrum(thin, interval);
    if (!(spectrum.totalPower() > 0)) return {};
    std::vector<Island> islands = spectrum.findIslands();
    if (islands.empty()) return {};
    const auto weaker = [](const Island& a, const Island& b) { return a.power < b.power; };
    const Island strongest = *std::max_element(islands.begin(), islands.end(), weaker);
    islands.erase(std::remove_if(islands.begin(), islands.end(),
                                 [&](const Island& island) { return island.power < least_power * strongest.power; }),
                  islands.end());
    if (islands.size() < 2 || islands.size() > most_tones) return {};
    double in_lines = 0;
    for (const Island& island : islands) {
        if (island.lobe < least_concentration * island.power) return {};
        in_lines += island.lobe;
    }
    if (in_lines < least_share * spectrum.totalPower()) return {};
    const Eigen::VectorXd course = spectrum.calcPowerOverTime(strongest);
    std::vector<double> frequencies;
    for (const Island& island : islands)
        if (spectrum.calcPowerOverTime(island).cwiseMin(course).sum() > least_common_share)
            frequencies.push_back(island.frequency);
    if (frequencies.size() < 2 || (!harmonics_count && areHarmonics(frequencies))) return {};
    return frequencies;
}

}  // namespace wems::identify
