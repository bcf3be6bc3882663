#include "identify/merge/merge.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "identify/merge/alignment.hpp"
#include "identify/motion/uniform_time.hpp"
#include "models/error.hpp"

namespace wems::identify {
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
