/// @file
/// Which channels share a picture, and in what unit they are shown.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace wems::identify::commands {

/// In what a channel is shown: displacements of mounts are read in millimetres.
struct ShownUnit {
    std::string name;
    double factor;
};
ShownUnit showUnit(const std::string& unit);

/// Channels of one part and one unit.
struct ChannelGroup {
    std::string title;  ///< `mobile, displacement`
    ShownUnit unit;
    std::vector<std::size_t> members;
};

/// @param channels name and SI unit of each
std::vector<ChannelGroup> groupChannels(const std::vector<std::pair<std::string, std::string>>& channels);

}  // namespace wems::identify::commands
