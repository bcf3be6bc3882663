#include "identify/diagnose/knob.hpp"

#include <Eigen/Geometry>
#include <limits>

#include "models/axis_numbers.hpp"
#include "models/parameter_access.hpp"
#include "models/structural_damping.hpp"

namespace wems::identify {
namespace {

constexpr double kLongestDelay = 0.02;  // s
constexpr double kLargestGain = 2.0;    // of a side of sensors or the load

bool endsWith(const std::string& name, const std::string& ending) {
    return name.size() >= ending.size() && name.compare(name.size() - ending.size(), ending.size(), ending) == 0;
}

/// Parameters of either sign.
bool isSigned(const std::string& name) {
    if (const AxisNumber* number = findAxisNumber(name.substr(name.rfind('.') + 1)))
        return number->range == AxisNumber::Range::any;
    for (const char* ending :
         {".x", ".y", ".z", "Ixy", "Ixz", "Iyz", ".delay", ".rx", ".ry", ".rz", ".ux", ".uy", ".uz"})
        if (endsWith(name, ending)) return true;
    return false;
}

}  // namespace

double Knob::get(const MountModel& model) const {
    const double value = getParameter(model, names.front());
    return isFactor() ? value / base.front() : value;
}

void Knob::set(MountModel& model, double value) const {
    for (std::size_t i = 0; i < names.size(); ++i) setParameter(model, names[i], isFactor() ? value * base[i] : value);
    if (!load_point) return;
    auto& mode = model.bracket[load_point->mode];
    mode.load_translation = mode.translation + mode.rotation.cross(load_point->position);
}

double Knob::scale(const MountModel& model) const {
    return isFactor() ? 1.0 : parameterScale(model, names.front());
}

double Knob::lowest(const MountModel& model) const {
    if (isFactor()) return 0.0;
    const auto& name = names.front();
    if (endsWith(name, ".delay")) return -kLongestDelay;
    if (endsWith(name, ".gain")) return 1 / kLargestGain;
    if (isSigned(name)) return -std::numeric_limits<double>::infinity();
    if (endsWith(name, ".clearance")) return 1e-5;
    if (endsWith(name, ".time_constant")) return 2e-4;
    if (endsWith(name, ".transition_velocity")) return 1e-5;
    if (endsWith(name, "body.mass") || endsWith(name, "Ixx") || endsWith(name, "Iyy") || endsWith(name, "Izz") ||
        endsWith(name, ".frequency"))
        return 0.05 * parameterScale(model, name);
    return 0.0;
}

double Knob::highest(const MountModel&) const {
    if (endsWith(names.front(), ".loss_factor")) return 0.9 * largestLossFactor();
    if (endsWith(names.front(), ".time_constant")) return 1.0;
    if (endsWith(names.front(), ".damping_ratio")) return 0.5;
    if (endsWith(names.front(), ".delay")) return kLongestDelay;
    if (endsWith(names.front(), ".gain")) return kLargestGain;
    return std::numeric_limits<double>::infinity();
}

Knob makeKnob(const std::string& name) {
    return {{name}, {}};
}

Knob makeSharedKnob(std::vector<std::string> names) {
    return {std::move(names), {}};
}

Knob makeFactorKnob(const MountModel& model, const std::vector<std::string>& names) {
    Knob knob;
    for (const auto& name : names) {
        const double value = getParameter(model, name);
        if (value == 0) continue;
        knob.names.push_back(name);
        knob.base.push_back(value);
    }
    return knob;
}

}  // namespace wems::identify
