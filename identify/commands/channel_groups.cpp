#include "identify/commands/channel_groups.hpp"

#include <algorithm>

namespace wems::identify::commands {
namespace {

std::string nameQuantity(const std::string& unit) {
    if (unit == "m") return "displacement";
    if (unit == "m/s") return "velocity";
    return unit == "m/s^2" ? "acceleration" : unit == "N" ? "force" : unit;
}

}  // namespace

ShownUnit showUnit(const std::string& unit) {
    return unit == "m" ? ShownUnit{"mm", 1e3} : ShownUnit{unit, 1};
}

std::vector<ChannelGroup> groupChannels(const std::vector<std::pair<std::string, std::string>>& channels) {
    std::vector<ChannelGroup> groups;
    for (std::size_t i = 0; i < channels.size(); ++i) {
        const auto& [name, unit] = channels[i];
        const std::string title = name.substr(0, name.find('.')) + ", " + nameQuantity(unit);
        auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.title == title; });
        if (group == groups.end()) group = groups.insert(group, {title, showUnit(unit), {}});
        group->members.push_back(i);
    }
    return groups;
}

}  // namespace wems::identify::commands
