#include "models/parameter_name.hpp"

#include <algorithm>
#include <optional>

#include "models/common/error.hpp"
#include "models/parameter_access.hpp"

namespace wems::parameter {
namespace {

constexpr double kNewStopRatio = 10.0;      // of the elastomer's stiffness
constexpr double kTypicalClearance = 1e-3;  // m

}  // namespace

void failName(const std::string& name, const std::string& problem) {
    throw InputError({{}, 0, name}, problem,
                     "names such as 1.z.stiffness, 4.z.+.clearance, body.mass, 3.frequency, load.gain, "
                     "mobile.1.az.gain");
}

std::vector<std::string> split(const std::string& name) {
    std::vector<std::string> parts(1);
    for (const char c : name) {
        if (c == '.')
            parts.emplace_back();
        else
            parts.back() += c;
    }
    return parts;
}

namespace {
std::optional<int> axisIndex(const std::string& text) {
    if (text == "x") return 0;
    if (text == "y") return 1;
    if (text == "z") return 2;
    return std::nullopt;
}

std::string join(const std::vector<std::string>& parts, std::size_t count) {
    std::string text = parts.at(0);
    for (std::size_t i = 1; i < count; ++i) text += "." + parts[i];
    return text;
}

Target parseBody(const std::string& name, const std::vector<std::string>& parts) {
    Target target;
    if (parts.size() == 2 && parts[1] == "mass") {
        target.kind = Target::Kind::mass;
        return target;
    }
    if (parts.size() == 3 && parts[1] == "inertia") {
        target.kind = Target::Kind::inertia;
        for (int i = 0; i < 6; ++i) {
            target.index = i;
            if (parts[2] == kInertiaNames[i]) return target;
        }
    }
    if (parts.size() == 3 && axisIndex(parts[2]) && (parts[1] == "center_of_gravity" || parts[1] == "spin")) {
        target.kind = parts[1] == "spin" ? Target::Kind::spin : Target::Kind::center_of_gravity;
        target.index = *axisIndex(parts[2]);
        return target;
    }
    failName(name, "the body has no such parameter");
}

Target parseLoad(const std::string& name, const std::vector<std::string>& parts) {
    Target target;
    target.kind = Target::Kind::load;
    target.index = -1;
    if (parts.size() == 2 && parts[1] == "gain") return target;
    if (parts.size() != 3 || parts[1] != "gain" || !axisIndex(parts[2]))
        failName(name, "the load has gain, gain.x, gain.y and gain.z only");
    target.index = *axisIndex(parts[2]);
    return target;
}

Target parseSensor(const std::string& name, const std::vector<std::string>& parts) {
    Target target;
    target.channel = join(parts, parts.size() - 1);
    target.parameter = parts.back();
    target.kind = Target::Kind::sensor;
    if (target.parameter == "gain" || target.parameter == "delay" || target.parameter == "zero") return target;
    if (target.parameter.size() == 2 && target.parameter[0] == 'r' && axisIndex(target.parameter.substr(1))) {
        target.kind = Target::Kind::sensor_rotation;
        target.index = *axisIndex(target.parameter.substr(1));
        return target;
    }
    failName(name, "a sensor has gain, delay, zero, rx, ry and rz only");
}

/// `frequency`, `damping_ratio`, `ux`, `rx`, `load.ux`, `base.ux` … after the row.
bool isModeParameter(const std::vector<std::string>& parts) {
    const auto& last = parts.back();
    if (parts.size() == 2 && (last == "frequency" || last == "damping_ratio")) return true;
    if (last.size() != 2 || !axisIndex(last.substr(1))) return false;
    if (parts.size() == 2) return last[0] == 'u' || last[0] == 'r';
    return parts.size() == 3 && last[0] == 'u' && (parts[1] == "load" || parts[1] == "base");
}

Target parseMode(const MountModel& model, const std::string& name, const std::vector<std::string>& parts) {
    Target target;
    target.kind = Target::Kind::mode;
    target.parameter = parts.size() == 2 ? parts[1] : parts[1] + "." + parts[2];
    target.index = -1;
    if (!parts[0].empty() && parts[0].size() < 6 &&
        std::all_of(parts[0].begin(), parts[0].end(), [](char c) { return c >= '0' && c <= '9'; }))
        target.index = std::stoi(parts[0]) - 1;
    if (target.index < 0 || target.index >= static_cast<int>(model.bracket.size()))
        failName(name, "the bracket has " + std::to_string(model.bracket.size()) + " modes");
    return target;
}

}  // namespace

Target parse(const MountModel& model, const std::string& name) {
    const auto parts = split(name);
    if (parts.size() < 2) failName(name, "not the name of a parameter");
    if (parts[0] == "body") return parseBody(name, parts);
    if (parts[0] == "mobile" || parts[0] == "fixed" || parts[0] == "base") return parseSensor(name, parts);
    if (parts[0] == "load") return parts.back() == "zero" ? parseSensor(name, parts) : parseLoad(name, parts);
    if (isModeParameter(parts)) return parseMode(model, name, parts);
    Target target;
    target.parameter = parts.back();
    std::size_t end = parts.size() - 1;
    if (end >= 2 && (parts[end - 1] == "+" || parts[end - 1] == "-")) {
        target.kind = Target::Kind::stop;
        target.side = parts[end - 1] == "+" ? Side::positive : Side::negative;
        --end;
    }
    if (end < 2 || !axisIndex(parts[end - 1])) failName(name, "not the name of a parameter");
    target.index = *axisIndex(parts[end - 1]);
    target.connection = model.connectionIndex(join(parts, end - 1));
    return target;
}

double newStopStiffness(const MountModel& model, const Target& target) {
    // The model's other stops along the same axis are the best guess, then any other, then the elastomer.
    double any = 0;
    for (const auto& connection : model.connections) {
        for (std::size_t a = 0; a < 3; ++a) {
            for (const auto& stop : connection.axis[a].stops) {
                if (static_cast<int>(a) == target.index) return stop.stiffness;
                any = stop.stiffness;
            }
        }
    }
    return any != 0 ? any : kNewStopRatio * lawOf(model, target).stiffness;
}

double typicalClearance(const MountModel& model) {
    double sum = 0;
    int count = 0;
    for (const auto& connection : model.connections)
        for (const auto& law : connection.axis)
            for (const auto& stop : law.stops) {
                sum += stop.clearance;
                ++count;
            }
    return count > 0 ? sum / count : kTypicalClearance;
}

}  // namespace wems::parameter
