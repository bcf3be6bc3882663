#include "plugin/run_overview.hpp"

#include <algorithm>
#include <utility>

namespace wems::plugin {

RunOverview::RunOverview(const Recording& header, std::size_t samples)
    : length_(samples / most_stretches + 1), present_(header.channels.size()) {
    for (const Channel& channel : header.channels) channels_.push_back({channel.name, {}, {}});
}

void RunOverview::add(const Recording& rows) {
    std::vector<double> values(channels_.size());
    for (std::size_t k = 0; k < rows.time.size(); ++k) {
        for (std::size_t c = 0; c < channels_.size(); ++c) values[c] = rows.channels[c].values[k];
        add(rows.time[k], values);
    }
}

void RunOverview::add(double time, const std::vector<double>& values) {
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        const Extreme sample{time, values[c]};
        Stretch& stretch = present_[c];
        if (filled_ == 0) stretch = {sample, sample};
        if (sample.value < stretch.lowest.value) stretch.lowest = sample;
        if (sample.value > stretch.highest.value) stretch.highest = sample;
    }
    if (++filled_ < length_) return;
    for (std::size_t c = 0; c < channels_.size(); ++c) close(c);
    filled_ = 0;
}

void RunOverview::close(std::size_t channel) {
    auto [first, last] = std::pair(present_[channel].lowest, present_[channel].highest);
    if (first.time > last.time) std::swap(first, last);
    ThinnedChannel& target = channels_[channel];
    const auto append = [&target](const Extreme& extreme) {
        target.time.push_back(extreme.time);
        target.values.push_back(extreme.value);
    };
    append(first);
    if (last.time > first.time) append(last);
}

const ThinnedChannel* RunOverview::find(const std::string& name) const {
    const auto found = std::find_if(channels_.begin(), channels_.end(),
                                    [&](const ThinnedChannel& channel) { return channel.name == name; });
    return found == channels_.end() ? nullptr : &*found;
}

}  // namespace wems::plugin
