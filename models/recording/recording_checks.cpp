#include "models/recording/recording_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

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

}  // namespace wems
