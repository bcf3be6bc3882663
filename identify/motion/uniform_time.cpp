#include "identify/motion/uniform_time.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "models/error.hpp"

namespace wems::identify {
namespace {

constexpr std::size_t minimum_samples = 8;
/// Deviations of a stamp below this part of the interval do not matter: at 1 m/s and 1 kHz they shift by 1 µm.
constexpr double harmless_deviation = 1e-3;

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
