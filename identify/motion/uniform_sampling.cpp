#include "identify/motion/uniform_sampling.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "models/common/error.hpp"

namespace wems::identify {
namespace {

constexpr std::size_t minimum_samples = 8;
/// Deviations of a stamp below this part of the interval do not matter: at 1 m/s and 1 kHz they shift by 1 µm.
constexpr double harmless_deviation = 1e-3;
/// Samples, so that the scatter of a mean over stretches is known to a fifth.
constexpr std::size_t kLeastForJitter = 1000;
/// Standard deviations of what chance would make, beyond which a statement about the stamps counts: 3e-7.
constexpr double kDeviations = 5;

/// Half a unit of the last decimal in which all stamps are written; zero if they are not decimal fractions.
double findRounding(const std::vector<double>& time) {
    double unit = 1;
    for (int decimals = 0; decimals <= 9; ++decimals, unit /= 10) {
        const bool all = std::all_of(time.begin(), time.end(), [unit](double t) {
            const double scaled = t / unit;
            return std::abs(scaled - std::round(scaled)) < 1e-6 * std::max(1.0, std::abs(scaled) * 1e-6);
        });
        if (all) return unit / 2;
    }
    return 0;
}

/// Stamps of a clock that samples evenly, nearest to `time` by least squares.
std::vector<double> fitEvenStamps(const std::vector<double>& time) {
    const auto n = static_cast<double>(time.size());
    const double middle = (n - 1) / 2;
    double mean = 0, slope = 0;
    for (std::size_t k = 0; k < time.size(); ++k) {
        mean += (time[k] - time.front()) / n;
        slope += (static_cast<double>(k) - middle) * (time[k] - time.front());
    }
    slope /= n * (n * n - 1) / 12;
    std::vector<double> even(time.size());
    for (std::size_t k = 0; k < time.size(); ++k)
        even[k] = time.front() + mean + (static_cast<double>(k) - middle) * slope;
    return even;
}

/// Each stamp is off by itself: the means of stretches of √n stamps scatter as those of independent deviations do.
bool jittersAlone(const std::vector<double>& time, const std::vector<double>& even) {
    const auto length = static_cast<std::size_t>(std::sqrt(static_cast<double>(time.size())));
    const std::size_t stretches = time.size() / length;
    double power = 0, of_means = 0;
    for (std::size_t s = 0; s < stretches; ++s) {
        double sum = 0;
        for (std::size_t k = s * length; k < (s + 1) * length; ++k) {
            sum += time[k] - even[k];
            power += (time[k] - even[k]) * (time[k] - even[k]);
        }
        of_means += sum * sum / static_cast<double>(length);
    }
    const double scatter = std::sqrt(2 / static_cast<double>(stretches));  // of a mean of squares
    return of_means / power * static_cast<double>(length) < 1 + kDeviations * scatter;
}

/// What the cubic through its four neighbours misses of a sample, per unit of white noise.
class Missed {
public:
    Missed(const std::vector<double>& time, std::size_t k) : first_(k - 2) {
        double power = 1;
        for (std::size_t i = 0; i < weights_.size(); ++i) {
            weights_[i] = i == 2 ? 1 : -1;
            for (std::size_t j = 0; i != 2 && j < weights_.size(); ++j)
                if (j != i && j != 2)
                    weights_[i] *= (time[k] - time[first_ + j]) / (time[first_ + i] - time[first_ + j]);
            if (i != 2) power += weights_[i] * weights_[i];
        }
        for (double& weight : weights_) weight /= std::sqrt(power);
    }
    double of(const std::vector<double>& values) const {
        double sum = 0;
        for (std::size_t i = 0; i < weights_.size(); ++i) sum += weights_[i] * values[first_ + i];
        return sum;
    }

private:
    std::size_t first_;
    std::array<double, 5> weights_{};
};

/// The samples follow a smooth course better at even instants than at their stamps. Stamps that are off by δ add noise
/// of velocity times δ to each channel; the likelihood of all channels, each with a noise of its own, tells which of
/// the two has it.
bool areSampledEvenly(const Recording& recording, const std::vector<double>& even) {
    const std::size_t n = recording.sampleCount();
    std::vector<Missed> at_stamps, at_even;
    for (std::size_t k = 2; k + 2 < n; ++k) {
        at_stamps.emplace_back(recording.time, k);
        at_even.emplace_back(even, k);
    }
    const std::size_t count = at_even.size();
    std::vector<double> gain(count);
    for (const Channel& channel : recording.channels) {
        std::vector<double> difference(count);
        double power = 0;
        for (std::size_t k = 0; k < count; ++k) {
            const double stamps = at_stamps[k].of(channel.values), uniform = at_even[k].of(channel.values);
            difference[k] = stamps * stamps - uniform * uniform;
            power += stamps * stamps + uniform * uniform;
        }
        if (!(power > 0)) continue;
        for (std::size_t k = 0; k < count; ++k) gain[k] += static_cast<double>(count) * difference[k] / power;
    }
    // Its scatter is that of stretches longer than what one sample enters.
    constexpr std::size_t kStretch = 10;
    double sum = 0, squares = 0;
    for (std::size_t first = 0; first < count; first += kStretch) {
        double own = 0;
        for (std::size_t k = first; k < std::min(first + kStretch, count); ++k) own += gain[k];
        sum += own;
        squares += own * own;
    }
    return sum > kDeviations * std::sqrt(squares);
}

}  // namespace

double interpolateCubic(const std::vector<double>& time, const std::vector<double>& values, std::size_t interval,
                        double t) {
    const std::size_t first = std::min(interval > 0 ? interval - 1 : 0, time.size() - 4);
    double sum = 0;
    for (std::size_t i = first; i < first + 4; ++i) {
        double weight = 1;
        for (std::size_t j = first; j < first + 4; ++j) {
            if (j != i) weight *= (t - time[j]) / (time[i] - time[j]);
        }
        sum += weight * values[i];
    }
    return sum;
}

Recording makeUniform(const Recording& recording, std::vector<std::string>& notes) {
    const std::size_t n = recording.sampleCount();
    if (n < minimum_samples)
        throw InputError({recording.file, 0, "time"}, "only " + std::to_string(n) + " samples",
                         "at least " + std::to_string(minimum_samples));
    const std::vector<double>& time = recording.time;
    const double h = (time.back() - time.front()) / static_cast<double>(n - 1);
    double deviation = 0, largest = 0, smallest = h;
    std::size_t gap = 0;
    for (std::size_t k = 0; k < n; ++k) {
        deviation = std::max(deviation, std::abs(time[k] - time.front() - static_cast<double>(k) * h));
        if (k == 0) continue;
        smallest = std::min(smallest, time[k] - time[k - 1]);
        if (time[k] - time[k - 1] > largest) {
            largest = time[k] - time[k - 1];
            gap = k;
        }
    }
    if (deviation < harmless_deviation * h) return recording;

    Recording uniform = recording;
    char text[240];
    // Two roundings (of the stamp, of the ends that define the interval) add up to two half units.
    const double rounding = deviation < h / 2 ? findRounding(time) : 0;
    if (rounding > 0 && deviation <= 2.02 * rounding && largest - smallest <= 2.02 * rounding) {
        for (std::size_t k = 0; k < n; ++k) uniform.time[k] = time.front() + static_cast<double>(k) * h;
        std::snprintf(text, sizeof text,
                      "time stamps are uniform within their %g s decimals; taken as uniform at %.6g Hz", 2 * rounding,
                      1 / h);
        notes.emplace_back(text);
        return uniform;
    }

    const std::vector<double> even = fitEvenStamps(time);
    if (n >= kLeastForJitter && jittersAlone(time, even) && areSampledEvenly(recording, even)) {
        double power = 0;
        for (std::size_t k = 0; k < n; ++k) power += (time[k] - even[k]) * (time[k] - even[k]);
        uniform.time = even;
        std::snprintf(
            text, sizeof text, "time stamps jitter by %.3g s RMS, the samples do not: taken as uniform at %.6g Hz",
            std::sqrt(power / static_cast<double>(n)), static_cast<double>(n - 1) / (even.back() - even.front()));
        notes.emplace_back(text);
        return uniform;
    }

    // The interval that most samples have, so that a gap does not thin out all the rest.
    std::vector<double> intervals(n - 1);
    for (std::size_t k = 1; k < n; ++k) intervals[k - 1] = time[k] - time[k - 1];
    std::nth_element(intervals.begin(), intervals.begin() + static_cast<long>(n / 2), intervals.end());
    const double target = intervals[n / 2];
    const auto count = static_cast<std::size_t>(std::floor((time.back() - time.front()) / target + 1e-6)) + 1;
    if (count > 20 * n)
        throw InputError({recording.file, recording.first_row + static_cast<long>(gap), "time"},
                         "the stamps leave gaps twenty times as long as what was recorded");
    std::vector<std::size_t> interval_of(count);
    uniform.time.resize(count);
    for (std::size_t k = 0, i = 0; k < count; ++k) {
        uniform.time[k] = std::min(time.front() + static_cast<double>(k) * target, time.back());
        while (i + 2 < n && time[i + 1] <= uniform.time[k]) ++i;
        interval_of[k] = i;
    }
    for (Channel& channel : uniform.channels) {
        std::vector<double> values(count);
        for (std::size_t k = 0; k < count; ++k)
            values[k] = interpolateCubic(time, channel.values, interval_of[k], uniform.time[k]);
        channel.values = std::move(values);
    }
    std::snprintf(text, sizeof text,
                  "time stamps are not uniform (%.4g to %.4g s); interpolated by cubics to %.6g Hz; the largest gap, "
                  "%.4g s at %.6g s, is bridged",
                  smallest, largest, 1 / target, largest, time[gap - 1]);
    notes.emplace_back(text);
    return uniform;
}

}  // namespace wems::identify
