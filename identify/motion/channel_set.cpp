#include "identify/motion/channel_set.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "models/error.hpp"

namespace wems::identify {

bool ChannelSet::hasCompleteTriads() const {
    if (channels.size() % 3 != 0) return false;
    for (std::size_t i = 0; i < channels.size(); ++i) {
        if (channels[i].axis != static_cast<int>(i % 3)) return false;
        if (channels[i].connection != channels[i - i % 3].connection) return false;
    }
    return true;
}

ChannelSet collectChannels(const Recording& recording, const MountModel& model, Part part, Derivative derivative) {
    ChannelSet set;
    set.file = recording.file;
    set.part = part;
    set.derivative = derivative;
    std::vector<std::pair<MarkerChannel, const Channel*>> found;
    for (const Channel& channel : recording.channels) {
        const auto name = parseChannelName(channel.name);
        if (!name || name->part != part || name->derivative != derivative) continue;
        MarkerChannel marker;
        marker.name = channel.name;
        marker.connection = model.connectionIndex(name->connection);
        marker.axis = name->axis;
        marker.position = model.connections[static_cast<std::size_t>(marker.connection)].position;
        found.emplace_back(marker, &channel);
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
        return std::pair(a.first.connection, a.first.axis) < std::pair(b.first.connection, b.first.axis);
    });
    const auto samples = static_cast<Eigen::Index>(recording.sampleCount());
    set.values.resize(static_cast<Eigen::Index>(found.size()), samples);
    for (const auto& [marker, channel] : found) {
        const auto bad = std::find_if_not(channel->values.begin(), channel->values.end(),
                                          [](double value) { return std::isfinite(value); });
        if (bad != channel->values.end())
            throw InputError({recording.file, recording.first_row + (bad - channel->values.begin()), channel->name},
                             "the value is not a finite number");
        set.channels.push_back(marker);
    }
    // Sample by sample within blocks that stay in the cache.
    constexpr Eigen::Index block = 512;
    for (Eigen::Index start = 0; start < samples; start += block) {
        const Eigen::Index count = std::min(block, samples - start);
        for (std::size_t i = 0; i < found.size(); ++i)
            set.values.row(static_cast<Eigen::Index>(i)).segment(start, count) =
                Eigen::Map<const Eigen::RowVectorXd>(found[i].second->values.data() + start, count);
    }
    return set;
}

std::vector<int> connectionsOf(const std::vector<MarkerChannel>& channels) {
    std::vector<int> connections;
    for (const MarkerChannel& channel : channels) {
        if (connections.empty() || connections.back() != channel.connection) connections.push_back(channel.connection);
    }
    return connections;
}

}  // namespace wems::identify
