#include "models/recording/recording_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>

#include "models/common/error.hpp"

namespace wems {

namespace {

constexpr double kGap = 1.5;              // intervals
constexpr std::size_t kClippedRun = 3;    // samples
constexpr double kUnevenInterval = 0.02;  // of the median interval

std::string formatShort(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}

class Checker {
public:
    Checker(const Recording& recording, const std::vector<long>& rows) : recording_(recording), rows_(rows) {}

    std::vector<Finding> run() {
        checkTime();
        for (const auto& channel : recording_.channels) {
            const Range range = findRange(channel);
            if (range.low == range.high) {
                checkConstant(channel, range.low);
            } else {
                checkClipped(channel, range);
            }
        }
        return std::move(findings_);
    }

private:
    long row(std::size_t sample) const {
        return rows_.empty() ? recording_.first_row + static_cast<long>(sample) : rows_[sample];
    }

    void add(FindingKind kind, const std::string& channel, std::size_t sample, const std::string& message) {
        findings_.push_back({kind, channel, row(sample), recording_.time[sample], channel + ": " + message});
    }

    void checkTime() {
        const auto& time = recording_.time;
        if (time.size() < 3) return;
        std::vector<double> intervals(time.size() - 1);
        for (std::size_t i = 0; i + 1 < time.size(); ++i) intervals[i] = time[i + 1] - time[i];
        auto sorted = intervals;
        const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
        std::nth_element(sorted.begin(), middle, sorted.end());
        const double median = *middle;

        std::size_t gaps = 0, longest = 0, uneven = 0, first_uneven = 0, first_gap = 0;
        for (std::size_t i = 0; i < intervals.size(); ++i) {
            if (intervals[i] > kGap * median) {
                if (gaps++ == 0) first_gap = i;
                if (gaps == 1 || intervals[i] > intervals[longest]) longest = i;
            } else if (std::abs(intervals[i] - median) > kUnevenInterval * median) {
                if (uneven++ == 0) first_uneven = i;
            }
        }
        if (gaps > 0) {
            add(FindingKind::gap, "time", first_gap + 1,
                std::to_string(gaps) + (gaps == 1 ? " gap" : " gaps") + ", the longest " +
                    formatShort(intervals[longest]) + " s before row " + std::to_string(row(longest + 1)) +
                    " (usual interval " + formatShort(median) + " s)");
        }
        if (uneven > 0) {
            add(FindingKind::non_uniform_time, "time", first_uneven + 1,
                "the stamps are not uniform: " + std::to_string(uneven) + " of " + std::to_string(intervals.size()) +
                    " intervals differ by more than 2 % from " + formatShort(median) + " s, first before row " +
                    std::to_string(row(first_uneven + 1)));
        }
    }

    struct Range {
        double low = 0, high = 0;
    };

    static Range findRange(const Channel& channel) {
        const auto& v = channel.values;
        if (v.empty()) return {};
        // Eight ranges side by side, so that no comparison waits for the one before.
        constexpr std::size_t lanes = 8;
        std::array<double, lanes> low{}, high{};
        low.fill(v.front());
        high.fill(v.front());
        std::size_t i = 0;
        for (; i + lanes <= v.size(); i += lanes) {
            for (std::size_t k = 0; k < lanes; ++k) {
                low[k] = v[i + k] < low[k] ? v[i + k] : low[k];
                high[k] = v[i + k] > high[k] ? v[i + k] : high[k];
            }
        }
        for (; i < v.size(); ++i) {
            low[0] = std::min(low[0], v[i]);
            high[0] = std::max(high[0], v[i]);
        }
        return {*std::min_element(low.begin(), low.end()), *std::max_element(high.begin(), high.end())};
    }

    /// Smallest change from sample to sample that is not zero.
    static double findStep(const std::vector<double>& v) {
        double step = std::numeric_limits<double>::infinity();
        for (std::size_t i = 1; i < v.size(); ++i) {
            const double change = std::abs(v[i] - v[i - 1]);
            if (change > 0 && change < step) step = change;
        }
        return step;
    }

    /// A channel at rest beside channels at rest is no fault, nor is an axis in which nothing moves; it is one if the
    /// same axis moves at another connection of the part or, on a test machine, on the other side of the law.
    void checkConstant(const Channel& channel, double value) {
        const auto name = parseChannelName(channel.name);
        if (!name || name->connection.empty() || recording_.sampleCount() < 3) return;
        const bool component = name->part == Part::relative || name->part == Part::force;
        for (const auto& other : recording_.channels) {
            const auto peer = parseChannelName(other.name);
            if (!peer || peer->axis != name->axis || &other == &channel) continue;
            const bool same_part = peer->part == name->part && peer->derivative == name->derivative;
            const bool other_side = component && peer->connection == name->connection && peer->part != name->part &&
                                    (peer->part == Part::relative || peer->part == Part::force);
            if (!same_part && !other_side) continue;
            const Range range = findRange(other);
            if (range.low == range.high) continue;
            add(FindingKind::constant, channel.name, 0,
                "constant at " + formatShort(value) + " while " + other.name + " moves");
            return;
        }
    }

    /// A plateau at the extreme value that the signal enters or leaves with a slope. A smooth peak of a signal printed
    /// to steps of s that stays L samples on one value changes by less than 4 s a sample beside them for L ≥ 3.
    void checkClipped(const Channel& channel, const Range& range) {
        double slope = -1;  // found when needed
        for (const double level : {range.high, range.low}) {
            if (level == 0) continue;  // rest, not a limit
            const auto& v = channel.values;
            if (std::count(v.begin(), v.end(), level) < static_cast<std::ptrdiff_t>(kClippedRun)) continue;
            if (slope < 0) slope = 4 * findStep(v);
            std::size_t runs = 0, samples = 0, first = 0;
            for (std::size_t i = 0; i < v.size(); ++i) {
                if (v[i] != level) continue;
                std::size_t end = i;
                while (end < v.size() && v[end] == level) ++end;
                if (end - i >= kClippedRun && hasSlopeBeside(v, i, end, slope)) {
                    if (runs++ == 0) first = i;
                    samples += end - i;
                }
                i = end;
            }
            if (runs == 0) continue;
            add(FindingKind::clipped, channel.name, first,
                "clipped: stays at its " + std::string(level == range.high ? "largest" : "smallest") + " value " +
                    formatShort(level) + " (SI) " + std::to_string(runs) + (runs == 1 ? " time, " : " times, ") +
                    std::to_string(samples) + " samples in all, first from row " + std::to_string(row(first)));
        }
    }

    /// Slope one sample off the plateau, because the step onto it is shortened by the limit.
    static bool hasSlopeBeside(const std::vector<double>& v, std::size_t begin, std::size_t end, double slope) {
        const bool before = begin >= 2 && std::abs(v[begin - 1] - v[begin - 2]) > slope;
        const bool after = end + 1 < v.size() && std::abs(v[end + 1] - v[end]) > slope;
        return before || after;
    }

    const Recording& recording_;
    const std::vector<long>& rows_;
    std::vector<Finding> findings_;
};

}  // namespace

std::vector<Finding> checkChannels(const Recording& recording, const std::vector<long>& rows) {
    return Checker(recording, rows).run();
}

namespace {

constexpr std::size_t kMaxFilled = 5;    // rows on end
constexpr std::size_t kMaxBackward = 3;  // rows
constexpr double kMaxRepeated = 0.1;     // of all rows
constexpr double kMaxCut = 0.5;          // of all rows
constexpr std::size_t kListedRows = 5;   // in a message

class Repair {
public:
    explicit Repair(Recording& recording) : recording_(recording) {
        rows_.resize(recording.time.size());
        for (std::size_t i = 0; i < rows_.size(); ++i) rows_[i] = recording.first_row + static_cast<long>(i);
    }

    std::vector<Finding> run() {
        dropBadStamps();
        const auto& channels = recording_.channels;
        if (std::any_of(channels.begin(), channels.end(), hasEmptyField)) {
            dropEmptyChannels();
            cutEnds();
            for (auto& channel : recording_.channels) fillGaps(channel);
        }
        for (auto& finding : checkChannels(recording_, rows_)) findings_.push_back(std::move(finding));
        return std::move(findings_);
    }

private:
    /// Without a branch inside, so that the compiler uses vector instructions.
    static bool hasEmptyField(const Channel& channel) {
        std::uint64_t found = 0;
        for (const double value : channel.values) found |= static_cast<std::uint64_t>(std::isnan(value));
        return found != 0;
    }

    void dropBadStamps() {
        const auto& time = recording_.time;
        std::vector<std::size_t> repeated, backward;
        std::vector<char> keep(time.size(), 1);
        double last = time.front();
        for (std::size_t i = 1; i < time.size(); ++i) {
            if (time[i] > last) {
                last = time[i];
                continue;
            }
            keep[i] = 0;
            (time[i] == last ? repeated : backward).push_back(i);
            if (backward.size() > kMaxBackward) {
                throw InputError({recording_.file, rows_[backward.front()], "time"},
                                 "time goes back, here and in later rows", "time stamps that increase");
            }
        }
        if (static_cast<double>(repeated.size()) > kMaxRepeated * static_cast<double>(time.size())) {
            throw InputError({recording_.file, rows_[repeated.front()], "time"},
                             std::to_string(repeated.size()) + " of " + std::to_string(time.size()) +
                                 " time stamps repeat the one before; does the column have too few digits?",
                             "time stamps that increase");
        }
        report(FindingKind::repeated_time, repeated, "repeated time stamp, row dropped");
        report(FindingKind::backward_time, backward, "time goes back, row dropped");
        if (repeated.empty() && backward.empty()) return;
        compact(recording_.time, keep);
        compact(rows_, keep);
        for (auto& channel : recording_.channels) compact(channel.values, keep);
    }

    void report(FindingKind kind, const std::vector<std::size_t>& samples, const std::string& what) {
        if (samples.empty()) return;
        addFinding(kind, "time", samples, "time: " + what);
    }

    void addFinding(FindingKind kind, const std::string& channel, const std::vector<std::size_t>& samples,
                    std::string message) {
        message += samples.size() == 1 ? ": row " : ": " + std::to_string(samples.size()) + " rows, ";
        for (std::size_t i = 0; i < std::min(samples.size(), kListedRows); ++i)
            message += (i > 0 ? ", " : "") + std::to_string(rows_[samples[i]]);
        if (samples.size() > kListedRows) message += " …";
        findings_.push_back({kind, channel, rows_[samples.front()], recording_.time[samples.front()], message});
    }

    template <typename T>
    static void compact(std::vector<T>& values, const std::vector<char>& keep) {
        std::size_t count = 0;
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (keep[i] != 0) values[count++] = values[i];
        }
        values.resize(count);
    }

    void dropEmptyChannels() {
        auto& channels = recording_.channels;
        const auto isEmpty = [](const Channel& channel) {
            return std::all_of(channel.values.begin(), channel.values.end(), [](double v) { return std::isnan(v); });
        };
        for (const auto& channel : channels) {
            if (!isEmpty(channel)) continue;
            findings_.push_back({FindingKind::empty_channel, channel.name, 0, 0,
                                 channel.name + ": the column has no values; the channel is ignored"});
        }
        channels.erase(std::remove_if(channels.begin(), channels.end(), isEmpty), channels.end());
        if (channels.empty()) throw InputError({recording_.file, recording_.first_row, {}}, "no channel has a value");
    }

    void cutEnds() {
        const std::size_t count = recording_.time.size();
        std::size_t first = 0, last = count;
        const Channel* late = nullptr;
        const Channel* early = nullptr;
        // A cut for one channel may bare an empty field of another one, so that one pass does not do.
        for (bool changed = true; changed;) {
            changed = false;
            for (const auto& channel : recording_.channels) {
                const auto& v = channel.values;
                for (; first < last && std::isnan(v[first]); ++first) {
                    late = &channel;
                    changed = true;
                }
                for (; first < last && std::isnan(v[last - 1]); --last) {
                    early = &channel;
                    changed = true;
                }
            }
        }
        if (late == nullptr && early == nullptr) return;
        const std::size_t kept = last - first;
        if (static_cast<double>(kept) < (1 - kMaxCut) * static_cast<double>(count)) {
            const Channel* worst = early == nullptr || (late != nullptr && first > count - last) ? late : early;
            throw InputError({recording_.file, worst == late ? rows_.front() : rows_[last], worst->name},
                             "more than half of the rows would be lost to empty fields at the start or the end",
                             "values in all channels over the same rows");
        }
        const auto add = [&](const Channel* channel, std::size_t sample, std::size_t number, const char* where) {
            if (channel == nullptr) return;
            findings_.push_back({FindingKind::missing_value, channel->name, rows_[sample], recording_.time[sample],
                                 channel->name + ": no values in the " + where + " " + std::to_string(number) +
                                     " rows (from row " + std::to_string(rows_[sample]) + "), which are cut off"});
        };
        add(late, 0, first, "first");
        add(early, last, count - last, "last");
        cut(recording_.time, first, last);
        cut(rows_, first, last);
        for (auto& channel : recording_.channels) cut(channel.values, first, last);
        recording_.first_row = rows_.front();
    }

    template <typename T>
    static void cut(std::vector<T>& values, std::size_t first, std::size_t last) {
        values.resize(last);
        values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(first));
    }

    /// Both neighbours of every run of NaN exist, because the ends are cut.
    void fillGaps(Channel& channel) {
        auto& v = channel.values;
        std::vector<std::size_t> filled;
        for (std::size_t i = 0; i < v.size(); ++i) {
            if (!std::isnan(v[i])) continue;
            std::size_t next = i;
            while (std::isnan(v[next])) ++next;
            if (next - i > kMaxFilled) {
                throw InputError({recording_.file, rows_[i], channel.name},
                                 "no value in " + std::to_string(next - i) + " rows on end",
                                 "at most " + std::to_string(kMaxFilled) + ", which are interpolated");
            }
            const double t0 = recording_.time[i - 1], t1 = recording_.time[next], v0 = v[i - 1];
            for (; i < next; ++i) {
                v[i] = v0 + (v[next] - v0) * ((recording_.time[i] - t0) / (t1 - t0));
                filled.push_back(i);
            }
        }
        if (!filled.empty()) {
            addFinding(FindingKind::missing_value, channel.name, filled,
                       channel.name + ": empty field, interpolated between its neighbours");
        }
    }

    Recording& recording_;
    std::vector<long> rows_;
    std::vector<Finding> findings_;
};

}  // namespace

std::vector<Finding> repairAndCheck(Recording& recording) {
    return Repair(recording).run();
}

}  // namespace wems
