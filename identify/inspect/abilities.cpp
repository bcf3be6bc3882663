#include "identify/inspect/abilities.hpp"

#include <algorithm>
#include <cmath>

#include "identify/forward/relative_displacement.hpp"
#include "identify/motion/channel_set.hpp"
#include "identify/motion/rigid_fit.hpp"
#include "models/error.hpp"
#include "models/format_number.hpp"

namespace wems::identify {
namespace {

bool has(const Recording& recording, Part part) {
    return std::any_of(recording.channels.begin(), recording.channels.end(), [part](const Channel& channel) {
        const auto name = parseChannelName(channel.name);
        return name && name->part == part;
    });
}

const char* describe(Derivative derivative) {
    switch (derivative) {
        case Derivative::displacement:
            return "displacement";
        case Derivative::velocity:
            return "velocity";
        case Derivative::acceleration:
            return "acceleration";
        case Derivative::force:
            break;
    }
    return "force";
}

void describePart(const Recording& recording, const MountModel* model, Part part, std::vector<std::string>& lines) {
    const std::string name = part == Part::mobile ? "mobile part" : "fixed part";
    for (const auto derivative : {Derivative::displacement, Derivative::velocity, Derivative::acceleration}) {
        const auto count = std::count_if(recording.channels.begin(), recording.channels.end(), [&](const Channel& c) {
            const auto parsed = parseChannelName(c.name);
            return parsed && parsed->part == part && parsed->derivative == derivative;
        });
        if (count == 0) continue;
        std::string line = name + ": " + std::to_string(count) + " " + describe(derivative) + " channels";
        if (model != nullptr) {
            try {
                const RigidFit fit(collectChannels(recording, *model, part, derivative), BodyMotion{});
                line += fit.undetermined().empty()
                            ? ", which determine all six motions" +
                                  (fit.redundancy() > 0 ? " with " + std::to_string(fit.redundancy()) + " to spare"
                                                        : std::string(", none to spare: no fault of a channel shows"))
                            : ", which leave open its " + joinWords(fit.undetermined());
            } catch (const InputError& error) {
                line += ": " + error.problem();
            }
        }
        lines.push_back(line);
    }
}

void describeComponents(const Recording& recording, std::vector<std::string>& lines) {
    const auto forces = recording.connections(Part::force);
    for (const auto& connection : recording.connections(Part::relative)) {
        const bool force = std::find(forces.begin(), forces.end(), connection) != forces.end();
        lines.push_back("element " + connection +
                        (force ? ": force and motion measured: its law can be fitted directly (fit, surface)"
                               : ": no force.* channel, so that its law cannot be told from this recording"));
    }
}

void describeStops(const MountModel& model, const std::vector<bool>& is_reached, std::vector<std::string>& lines) {
    std::vector<std::string> reached, missed;
    std::size_t next = 0;
    for (const Connection& connection : model.connections) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            for (const Stop& stop : connection.axis.at(axis).stops) {
                const std::string name =
                    connection.name + "." + static_cast<char>('x' + axis) + (stop.side == Side::positive ? ".+" : ".-");
                (is_reached.at(next++) ? reached : missed).push_back(name);
            }
        }
    }
    if (!reached.empty()) lines.push_back("stops reached with the model's clearances: " + joinWords(reached));
    if (!missed.empty())
        lines.push_back("stops not reached, so that nothing can be said of them: " + joinWords(missed));
}

}  // namespace

std::vector<bool> findReachedStops(const Recording& recording, const MountModel& model) {
    RelativeDisplacement relative;
    try {
        relative = calcRelativeDisplacement(recording, model);
    } catch (const InputError&) {
        return {};
    }
    std::vector<bool> reached;
    for (std::size_t i = 0; i < model.connections.size(); ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            const AxisLaw& law = model.connections[i].axis.at(axis);
            const Eigen::RowVectorXd q = relative.q.row(3 * i + axis).array() + law.offset;  // from mid-gap
            for (const Stop& stop : law.stops)
                reached.push_back((stop.side == Side::positive ? q.maxCoeff() : -q.minCoeff()) > stop.clearance);
        }
    }
    return reached;
}

std::vector<std::string> describeAbilities(const Recording& recording, const MountModel* model,
                                           const std::vector<bool>& reached) {
    std::vector<std::string> lines;
    const bool component = has(recording, Part::relative) || has(recording, Part::force);
    if (has(recording, Part::load)) {
        lines.emplace_back("drive: the load is recorded and is used as it was, not as commanded");
    } else if (has(recording, Part::base)) {
        lines.emplace_back("drive: the base's motion is recorded; forces follow from the mass of the mobile part");
    } else if (!component) {
        lines.emplace_back(
            "drive: neither load nor base is recorded; simulations are driven by the fixed part's motion, and forces "
            "follow from the mass of the mobile part");
    }
    describePart(recording, model, Part::mobile, lines);
    describePart(recording, model, Part::fixed, lines);
    if (component) describeComponents(recording, lines);
    if (model != nullptr && !reached.empty()) describeStops(*model, reached, lines);
    if (!has(recording, Part::mobile) && !component)
        lines.emplace_back("no channel of the mobile part and none of a component test: nothing can be identified");
    return lines;
}

}  // namespace wems::identify
