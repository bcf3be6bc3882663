// What every reader promises of a recording that it accepts.
#pragma once

#include <cmath>
#include <cstdlib>

#include "models/recording/recording.hpp"

namespace wems::fuzz {

inline void require(bool condition) {
    if (!condition) std::abort();
}

inline void checkPromises(const Recording& recording) {
    require(!recording.time.empty() && !recording.channels.empty());
    for (std::size_t i = 0; i < recording.time.size(); ++i) {
        require(std::isfinite(recording.time[i]));
        require(i == 0 || recording.time[i] > recording.time[i - 1]);
    }
    for (const auto& channel : recording.channels) {
        require(channel.values.size() == recording.time.size());
        require(parseChannelName(channel.name).has_value());
        for (const double value : channel.values) require(std::isfinite(value));
    }
}

}  // namespace wems::fuzz
