#include "identify/motion/tones.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "identify/motion/fftw_plan.hpp"
#include "models/pi.hpp"

namespace wems::identify {
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
    LineSpectrum(const Eigen::VectorXd& signal, double interval) : samples_(signal.size()) {
        Eigen::Index length = 1;
        while (length < samples_) length *= 2;
        std::vector<double> padded(length, 0.0);
        const double mean = signal.mean();
        for (Eigen::Index i = 0; i < samples_; ++i) {
            const double phase = kTwoPi * (static_cast<double>(i) + 0.5) / static_cast<double>(samples_);
            padded[i] = (0.5 - 0.5 * std::cos(phase)) * (signal[i] - mean);
        }
        transform_.resize(length / 2 + 1);
        const FftwPlan plan(
            fftw_plan_dft_r2c_1d(static_cast<int>(length), padded.data(), asFftw(transform_.data()), FFTW_ESTIMATE));
        fftw_execute(plan.get());
        bin_ = 1 / (static_cast<double>(length) * interval);
        lobe_ = static_cast<Eigen::Index>(
            std::ceil(half_lobe * static_cast<double>(length) / static_cast<double>(samples_)));
        power_.resize(length / 2 + 1);
        for (Eigen::Index i = 0; i < power_.size(); ++i) power_[i] = i < lobe_ ? 0 : std::norm(transform_[i]);
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
        std::vector<std::complex<double>> part(transform_.size());
        const std::ptrdiff_t first = std::max<Eigen::Index>(0, island.first - lobe_);
        const auto last = static_cast<std::ptrdiff_t>(std::min(power_.size() - 1, island.last + lobe_));
        std::copy(transform_.begin() + first, transform_.begin() + last + 1, part.begin() + first);
        const std::size_t length = 2 * (transform_.size() - 1);
        std::vector<double> values(length);
        const FftwPlan plan(
            fftw_plan_dft_c2r_1d(static_cast<int>(length), asFftw(part.data()), values.data(), FFTW_ESTIMATE));
        fftw_execute(plan.get());
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
    std::vector<std::complex<double>> transform_;
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
