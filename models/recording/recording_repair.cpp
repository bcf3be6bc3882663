#include <algorithm>
#include <cmath>
#include <cstdint>

#include "models/error.hpp"
#include "models/recording/recording_checks.hpp"

namespace wems {
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
