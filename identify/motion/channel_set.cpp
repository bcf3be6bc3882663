#include "identify/motion/channel_set.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "models/error.hpp"

namespace wems::identify {

namespace {

using FoundChannel = std::pair<MarkerChannel, const Channel*>;

MarkerChannel makeMarker(const std::string& channel, const ChannelName& name, const MountModel& model) {
    MarkerChannel marker;
    marker.name = channel;
    marker.station = name.connection;
    marker.axis = name.axis;
    const int place_index = model.placeIndex(name);
    if (place_index < 0) {
        marker.index = model.connectionIndex(name.connection);
        marker.position = model.connections[marker.index].position;
        marker.direction = Eigen::Vector3d::Unit(name.axis);
        return marker;
    }
    const SensorPlace& place = model.places[place_index];
    marker.index = static_cast<int>(model.connections.size()) + place_index;
    marker.position = place.position;
    marker.direction = place.direction(name.axis);
    marker.turning = place.accelerometer;
    return marker;
}

/// Weights from the noise that the layout states; a channel without a statement has the noise of the best.
void setWeights(std::vector<FoundChannel>& found, const MountModel& model) {
    const auto noiseOf = [&](const MarkerChannel& marker) {
        const int place = marker.index - static_cast<int>(model.connections.size());
        return place < 0 ? 0.0 : model.places[place].noise;
    };
    double least = 0;
    for (const auto& [marker, channel] : found) {
        const double noise = noiseOf(marker);
        if (noise > 0 && (least == 0 || noise < least)) least = noise;
    }
    for (auto& [marker, channel] : found) {
        const double noise = noiseOf(marker);
        if (noise > 0) marker.weight = least / noise;
    }
}

}  // namespace

bool MarkerChannel::isPlain() const {
    return !turning && weight == 1 && direction == Eigen::Vector3d::Unit(axis);
}

bool ChannelSet::hasCompleteTriads() const {
    if (channels.size() % 3 != 0) return false;
    for (std::size_t i = 0; i < channels.size(); ++i) {
        if (channels[i].axis != static_cast<int>(i % 3) || !channels[i].isPlain()) return false;
        if (channels[i].index != channels[i - i % 3].index) return false;
    }
    return true;
}

ChannelSet collectChannels(const Recording& recording, const MountModel& model, Part part, Derivative derivative) {
    ChannelSet set;
    set.file = recording.file;
    set.part = part;
    set.derivative = derivative;
    std::vector<FoundChannel> found;
    for (const Channel& channel : recording.channels) {
        const auto name = parseChannelName(channel.name);
        if (!name || name->part != part || name->derivative != derivative) continue;
        found.emplace_back(makeMarker(channel.name, *name, model), &channel);
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
        return std::pair(a.first.index, a.first.axis) < std::pair(b.first.index, b.first.axis);
    });
    setWeights(found, model);
    const Eigen::Index samples = recording.sampleCount();
    set.values.resize(found.size(), samples);
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
            set.values.row(i).segment(start, count) =
                Eigen::Map<const Eigen::RowVectorXd>(found[i].second->values.data() + start, count);
    }
    return set;
}

}  // namespace wems::identify
