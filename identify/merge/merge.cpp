#include "identify/merge/merge.hpp"

#include <algorithm>
#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <complex>
#include <cstdio>
#include <memory>
#include <numeric>

#include "identify/motion/real_transform.hpp"
#include "identify/motion/uniform_sampling.hpp"
#include "models/common/error.hpp"
#include "models/common/units.hpp"

namespace wems::identify {

namespace {

constexpr double crossings = 32;
constexpr double beta = 8;
constexpr double cutoff_share = 0.464;  // of the lower rate: the stop band begins at its half
constexpr int table_steps = 512;        // for each zero crossing
// Of a sample: what times may differ by that are alike up to rounding. It moves a value by no more than pi times that
// of the signal, as nothing lies above half the rate.
constexpr double same_place = 1e-6;

/// The windowed sinc over |x| in zero crossings, tabulated and linearly interpolated.
class Kernel {
public:
    Kernel() {
        const double scale = boost::math::cyl_bessel_i(0, beta);
        const auto count = static_cast<std::size_t>(crossings * table_steps);
        table_.resize(count + 2, 0.0);
        for (std::size_t i = 0; i < count; ++i) {
            const double x = static_cast<double>(i) / table_steps, share = x / crossings;
            const double window = boost::math::cyl_bessel_i(0, beta * std::sqrt(1 - share * share)) / scale;
            table_[i] = (i == 0 ? 1.0 : std::sin(kPi * x) / (kPi * x)) * window;
        }
    }

    double operator()(double x) const {
        const double at = std::abs(x) * table_steps;
        const auto i = static_cast<std::size_t>(at);
        if (i + 1 >= table_.size()) return 0;
        const double share = at - static_cast<double>(i);
        return (1 - share) * table_[i] + share * table_[i + 1];
    }

private:
    std::vector<double> table_;
};

}  // namespace

namespace {

/// Weights of the samples from `first` on for a value between samples, scaled to keep a constant.
struct SincWeights {
    long first;
    std::vector<double> values;
};

/// @param at sample that the value lies at @param reach samples on each side
/// @param crossing samples between zeros @param last sample of the signal
SincWeights calcWeights(const Kernel& kernel, double at, double reach, double crossing, double last) {
    SincWeights weights{static_cast<long>(std::clamp(std::ceil(at - reach), 0.0, last)), {}};
    const auto end = static_cast<long>(std::clamp(std::floor(at + reach), 0.0, last));
    double sum = 0;
    for (long i = weights.first; i <= end; ++i) {
        weights.values.push_back(kernel((static_cast<double>(i) - at) / crossing));
        sum += weights.values.back();
    }
    for (double& weight : weights.values) weight = sum != 0 ? weight / sum : 0;
    return weights;
}

}  // namespace

UniformSignal resample(const UniformSignal& signal, double start, double interval, std::size_t count) {
    const Kernel kernel;
    UniformSignal result{start, interval, std::vector<double>(count)};
    const double crossing = std::max(signal.interval, interval) / (2 * cutoff_share * signal.interval);
    const double reach = crossings * crossing, last = static_cast<double>(signal.values.size() - 1);
    const auto placeOf = [&](std::size_t k) {
        return (start - signal.start + static_cast<double>(k) * interval) / signal.interval;
    };
    // Where a whole number of values falls on each sample, weights come again with that number.
    const double ratio = signal.interval / interval, whole = std::round(ratio);
    const bool repeats =
        whole >= 1 && std::abs(ratio - whole) * static_cast<double>(count) < same_place * whole * whole;
    const std::size_t phases = repeats ? std::min(static_cast<std::size_t>(whole), count) : 0;
    std::vector<SincWeights> kept;
    for (std::size_t k = 0; k < phases; ++k) {
        // As deep within the signal as the sinc reaches.
        const double inside = std::ceil(reach) + placeOf(k) - std::floor(placeOf(k));
        kept.push_back(calcWeights(kernel, inside, reach, crossing, 2 * inside + 1));
        kept.back().first += static_cast<long>(std::floor(placeOf(k)) - std::ceil(reach));
    }
    const auto samples = static_cast<long>(signal.values.size());
    const auto weigh = [&](const std::vector<double>& weights, long first) {
        return std::inner_product(weights.begin(), weights.end(), signal.values.begin() + first, 0.0);
    };
    for (std::size_t k = 0; k < count; ++k) {
        if (repeats) {
            const SincWeights& weights = kept[k % phases];
            const long first = weights.first + static_cast<long>(k / phases);
            if (first >= 0 && first + static_cast<long>(weights.values.size()) <= samples) {
                result.values[k] = weigh(weights.values, first);
                continue;
            }
        }
        const SincWeights weights = calcWeights(kernel, placeOf(k), reach, crossing, last);
        result.values[k] = weigh(weights.values, weights.first);
    }
    return result;
}

namespace {

constexpr int refinements = 6;
constexpr std::size_t least_overlap = 64;  // samples

UniformSignal atRate(const UniformSignal& signal, double interval) {
    if (interval <= signal.interval * (1 + 1e-9)) return signal;
    const auto count = static_cast<std::size_t>((signal.end() - signal.start) / interval) + 1;
    return resample(signal, signal.start, interval, count);
}

Eigen::VectorXd removeMean(const std::vector<double>& values) {
    const Eigen::Map<const Eigen::VectorXd> all(values.data(), values.size());
    return all.array() - all.mean();
}

/// Lag l, in samples, that maximises Σ a_k b_{k+l}.
long findLag(const std::vector<double>& a, const std::vector<double>& b) {
    Eigen::Index length = 1;
    while (static_cast<std::size_t>(length) < a.size() + b.size()) length *= 2;
    const RealTransform transform(length);
    const Eigen::VectorXcd product =
        transform.forward(removeMean(a)).conjugate().cwiseProduct(transform.forward(removeMean(b)));
    Eigen::Index best = 0;
    transform.inverse(product).maxCoeff(&best);
    return static_cast<std::size_t>(best) < b.size() ? best : best - length;
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

namespace {

constexpr double least_correlation = 0.5;
constexpr double odd_gain = 0.02;  // difference of gains that is worth a word

UniformSignal takeSignal(const Recording& recording, const Channel& channel) {
    return {recording.time.front(), recording.sampleInterval(), channel.values};
}

const Channel& findCommon(const Recording& recording, const std::string& name) {
    const Channel* channel = recording.find(name);
    if (channel == nullptr) {
        constexpr std::size_t kShown = 6;
        std::string names;
        for (std::size_t i = 0; i < std::min(kShown, recording.channels.size()); ++i)
            names += (i == 0 ? "" : ", ") + recording.channels[i].name;
        if (recording.channels.size() > kShown)
            names +=
                " and " + std::to_string(recording.channels.size() - kShown) + " more, which `identify inspect` lists";
        throw InputError({recording.file, 0, name}, "the common channel is not in this recording", names);
    }
    return *channel;
}

void describeAlignment(const Alignment& found, const Recording& recording, std::vector<std::string>& notes) {
    char text[200];
    std::snprintf(text, sizeof text, ": shifted by %.6g s ± %.2g s, correlation %.4f", found.shift, 2 * found.deviation,
                  found.correlation);
    notes.push_back(recording.file + text);
    if (std::abs(found.gain - 1) > odd_gain) {
        std::snprintf(text, sizeof text, ": its common channel is %.4g times the first one's", found.gain);
        notes.push_back(recording.file + text);
    }
    if (found.drift != 0) {
        std::snprintf(
            text, sizeof text,
            ": the shift changes by %.3g s from the first third to the last: the clocks do not run alike, which "
            "is not corrected",
            found.drift);
        notes.push_back(recording.file + text);
    }
}

}  // namespace

MergedRecording merge(const std::vector<Recording>& recordings, const MergeOptions& options) {
    if (recordings.size() < 2) throw InputError({}, "one recording alone cannot be merged", "two or more");
    MergedRecording merged;
    Recording& result = merged.recording;
    std::vector<Recording> uniform;
    std::vector<double> shifts;
    double interval = options.rate > 0 ? 1 / options.rate : 0;
    double from = -INFINITY, to = INFINITY;
    for (const Recording& recording : recordings) {
        std::vector<std::string> notes;
        uniform.push_back(makeUniform(recording, notes));
        for (const auto& note : notes) result.warnings.push_back(recording.file + ": " + note);
        double shift = 0;
        if (uniform.size() > 1 && !options.common.empty()) {
            const Channel& reference = findCommon(uniform.front(), options.common);
            const Channel& own = findCommon(uniform.back(), options.common);
            const Alignment found = align(takeSignal(uniform.front(), reference), takeSignal(uniform.back(), own));
            if (!(std::abs(found.correlation) >= least_correlation))
                throw InputError({recording.file, 0, options.common},
                                 "does not match that of " + recordings.front().file + " at any shift",
                                 "a channel that both recorded in the same run");
            describeAlignment(found, recording, result.warnings);
            shift = found.shift;
        }
        shifts.push_back(shift);
        if (!options.common.empty()) {
            merged.common.push_back(
                {recording.file, takeSignal(uniform.back(), findCommon(uniform.back(), options.common))});
            merged.common.back().signal.start += shift;
        }
        from = std::max(from, uniform.back().time.front() + shift);
        to = std::min(to, uniform.back().time.back() + shift);
        if (options.rate <= 0) interval = std::max(interval, uniform.back().sampleInterval());
    }
    if (!(to - from > 16 * interval))
        throw InputError({recordings.back().file, 0, "time"}, "the recordings have no time in common",
                         "--common CHANNEL, which aligns them");
    const auto count = static_cast<std::size_t>((to - from) / interval + 1e-9) + 1;
    result.file = recordings.front().file;
    result.metadata = recordings.front().metadata;
    for (std::size_t k = 0; k < count; ++k) result.time.push_back(from + static_cast<double>(k) * interval);
    for (std::size_t i = 0; i < uniform.size(); ++i) {
        for (const Channel& channel : uniform[i].channels) {
            if (result.find(channel.name) != nullptr) {
                if (channel.name == options.common) continue;
                throw InputError({recordings[i].file, 0, channel.name}, "is in another of these recordings already",
                                 "each channel once, but for the common one");
            }
            UniformSignal signal = takeSignal(uniform[i], channel);
            signal.start += shifts[i];
            const bool as_it_is = std::abs(signal.interval - interval) < 1e-9 * interval &&
                                  std::abs(signal.start - from) < 1e-9 * interval;
            Channel resampled = channel;
            resampled.column = static_cast<int>(result.channels.size()) + 2;
            if (as_it_is) {
                resampled.values.resize(count);
            } else {
                resampled.values = resample(signal, from, interval, count).values;
            }
            result.channels.push_back(std::move(resampled));
        }
    }
    return merged;
}

}  // namespace wems::identify
