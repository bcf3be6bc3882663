#include "models/recording/recording.hpp"

#include <algorithm>
#include <array>

namespace wems {

const char* kindName(FindingKind kind) {
    switch (kind) {
        case FindingKind::repeated_time:
            return "repeated_time";
        case FindingKind::backward_time:
            return "backward_time";
        case FindingKind::gap:
            return "gap";
        case FindingKind::non_uniform_time:
            return "non_uniform_time";
        case FindingKind::missing_value:
            return "missing_value";
        case FindingKind::empty_channel:
            return "empty_channel";
        case FindingKind::clipped:
            return "clipped";
        case FindingKind::saturated:
            return "saturated";
        case FindingKind::drop_out:
            return "drop_out";
        case FindingKind::hum:
            return "hum";
        case FindingKind::offset:
            return "offset";
        case FindingKind::drift:
            return "drift";
        case FindingKind::constant:
            return "constant";
        case FindingKind::missing_connection:
            return "missing_connection";
        case FindingKind::unknown_connection:
            return "unknown_connection";
        case FindingKind::swapped:
            break;
    }
    return "swapped";
}

namespace {

struct PartName {
    Part part;
    const char* name;
};
constexpr std::array<PartName, 6> kParts = {{{Part::mobile, "mobile"},
                                             {Part::fixed, "fixed"},
                                             {Part::relative, "relative"},
                                             {Part::force, "force"},
                                             {Part::load, "load"},
                                             {Part::base, "base"}}};

/// Letters before the axis: none, v, a or f.
std::optional<std::pair<Derivative, int>> parseQuantity(const std::string& text) {
    if (text.empty() || text.size() > 2) return std::nullopt;
    const char axis = text.back();
    if (axis < 'x' || axis > 'z') return std::nullopt;
    if (text.size() == 1) return std::pair{Derivative::displacement, axis - 'x'};
    switch (text.front()) {
        case 'v':
            return std::pair{Derivative::velocity, axis - 'x'};
        case 'a':
            return std::pair{Derivative::acceleration, axis - 'x'};
        case 'f':
            return std::pair{Derivative::force, axis - 'x'};
        default:
            return std::nullopt;
    }
}

}  // namespace

std::optional<ChannelName> parseChannelName(const std::string& name) {
    const auto first = name.find('.');
    if (first == std::string::npos) return std::nullopt;
    const auto last = name.rfind('.');
    const auto part = std::find_if(kParts.begin(), kParts.end(),
                                   [&](const PartName& known) { return name.compare(0, first, known.name) == 0; });
    const auto quantity = parseQuantity(name.substr(last + 1));
    if (part == kParts.end() || !quantity) return std::nullopt;
    ChannelName parsed;
    parsed.part = part->part;
    parsed.derivative = quantity->first;
    parsed.axis = quantity->second;
    if (parsed.part == Part::load || parsed.part == Part::base) {
        const auto only = parsed.part == Part::load ? Derivative::force : Derivative::acceleration;
        if (first != last || parsed.derivative != only) return std::nullopt;
        return parsed;
    }
    if (last <= first + 1 || parsed.derivative == Derivative::force) return std::nullopt;
    parsed.connection = name.substr(first + 1, last - first - 1);
    if (parsed.part == Part::force) {
        if (parsed.derivative != Derivative::displacement) return std::nullopt;
        parsed.derivative = Derivative::force;
    }
    return parsed;
}

std::string formatChannelName(const ChannelName& name) {
    std::string text = kParts.at(static_cast<std::size_t>(name.part)).name;
    text += '.';
    const bool has_connection = name.part != Part::load && name.part != Part::base;
    if (has_connection) text += name.connection + '.';
    if (name.derivative == Derivative::velocity) text += 'v';
    if (name.derivative == Derivative::acceleration) text += 'a';
    if (name.derivative == Derivative::force && name.part == Part::load) text += 'f';
    text += static_cast<char>('x' + name.axis);
    return text;
}

Quantity findQuantity(const ChannelName& name) {
    switch (name.derivative) {
        case Derivative::displacement:
            return Quantity::length;
        case Derivative::velocity:
            return Quantity::velocity;
        case Derivative::acceleration:
            return Quantity::acceleration;
        case Derivative::force:
            break;
    }
    return Quantity::force;
}

const Channel* Recording::find(const std::string& name) const {
    const auto found =
        std::find_if(channels.begin(), channels.end(), [&](const Channel& channel) { return channel.name == name; });
    return found == channels.end() ? nullptr : &*found;
}

double Recording::sampleInterval() const {
    if (time.size() < 2) return 0;
    return (time.back() - time.front()) / static_cast<double>(time.size() - 1);
}

std::vector<std::string> Recording::connections(Part part) const {
    std::vector<std::string> names;
    for (const auto& channel : channels) {
        const auto parsed = parseChannelName(channel.name);
        if (!parsed || parsed->part != part || parsed->connection.empty()) continue;
        if (std::find(names.begin(), names.end(), parsed->connection) == names.end())
            names.push_back(parsed->connection);
    }
    return names;
}

}  // namespace wems
