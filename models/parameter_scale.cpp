#include <algorithm>
#include <cmath>

#include "models/axis_numbers.hpp"
#include "models/parameter_access.hpp"
#include "models/parameter_name.hpp"

namespace wems {

using namespace parameter;

namespace {

constexpr double kTypicalDisplacement = 1e-3;  // m
constexpr double kTypicalFrequency = 125.0;    // rad/s, middle of 5–50 Hz

double typicalStiffness(const MountModel& model, const AxisLaw& law) {
    if (law.stiffness > 0) return law.stiffness;
    double sum = 0;
    int count = 0;
    for (const auto& connection : model.connections)
        for (const auto& other : connection.axis)
            if (other.stiffness > 0) {
                sum += other.stiffness;
                ++count;
            }
    return count > 0 ? sum / count : 1.0;
}

double axisScale(const MountModel& model, const Target& target, const std::string& name) {
    const auto& law = lawOf(model, target);
    const double stiffness = typicalStiffness(model, law);
    const auto& p = target.parameter;
    if (p == "stiffness") return stiffness;
    if (p == "damping") return std::max(law.damping, 0.02 * stiffness / kTypicalFrequency);
    if (p == "offset") return 0.1 * typicalClearance(model);
    if (p == "cubic") return 0.1 * stiffness / (kTypicalDisplacement * kTypicalDisplacement);
    if (p == "drift") return 1e-3;
    if (p == "friction_force" || p == "hysteresis_force") return 0.1 * kTypicalDisplacement * stiffness;
    if (p == "yield_displacement" || p == "exponent" || p == "shape") return getParameter(model, name);
    if (p == "transition_velocity") return 1e-3;
    if (p == "presliding_stiffness") return stiffness;
    if (p == "dissipation") return 0.5;
    if (p == "time_constant") return law.relaxation ? law.relaxation->time_constant : 0.01;
    if (p == "loss_factor" || p == "stiffness_ratio") return 0.1;
    failName(name, "a parameter without typical size");
}

/// Shapes matter at the size of the model's other shapes of their kind, the same for all three components.
double modeScale(const MountModel& model, const Target& target, const std::string& name) {
    const auto& p = target.parameter;
    if (p == "frequency" || p == "damping_ratio") return getParameter(model, name);
    double largest = 0;
    for (const auto& mode : model.bracket)
        largest = std::max(largest, (p.rfind("load.", 0) == 0   ? mode.load_translation
                                     : p.rfind("base.", 0) == 0 ? mode.base_participation
                                     : p[0] == 'r'              ? mode.rotation
                                                                : mode.translation)
                                        .norm());
    return largest > 0 ? largest : 1.0;
}

}  // namespace

std::string parameterUnit(const std::string& name) {
    const auto parts = split(name);
    const auto& p = parts.back();
    const bool of_mode = !parts[0].empty() && parts[0] != "mobile" && parts[0] != "fixed" && parts[0] != "base";
    if (of_mode && p.size() == 2 && (p[0] == 'u' || p[0] == 'r'))
        return p[0] == 'r' ? "kg^-1/2 m^-1" : parts[1] == "base" ? "kg^1/2" : "kg^-1/2";
    if (parts[0] == "body") {
        if (p == "mass") return "kg";
        if (parts.size() > 1 && parts[1] == "inertia") return "kg m^2";
        return parts.size() > 1 && parts[1] == "spin" ? "N m s" : "m";
    }
    if (const AxisNumber* number = findAxisNumber(p)) return number->unit;
    if (p == "presliding_stiffness") return "N/m";
    if (p == "clearance" || p == "yield_displacement") return "m";
    if (p == "time_constant" || p == "delay") return "s";
    if (p == "friction_force" || p == "hysteresis_force") return "N";
    if (p == "transition_velocity") return "m/s";
    if (p == "dissipation") return "s/m";
    if (p == "frequency") return "Hz";
    if (p == "rx" || p == "ry" || p == "rz") return "rad";
    return "-";
}

double parameterScale(const MountModel& model, const std::string& name) {
    const auto target = parse(model, name);
    const double trace = model.body.inertia.trace() / 3.0;
    switch (target.kind) {
        case Target::Kind::axis:
            return axisScale(model, target, name);
        case Target::Kind::stop: {
            const Stop* stop = findStop(lawOf(model, target), target.side);
            if (target.parameter == "dissipation") return 0.5;
            if (target.parameter == "clearance") return stop ? stop->clearance : typicalClearance(model);
            return stop && stop->stiffness != 0 ? std::abs(stop->stiffness) : newStopStiffness(model, target);
        }
        case Target::Kind::mass:
            return model.body.mass;
        case Target::Kind::center_of_gravity:
            return 0.1 * std::sqrt(trace / model.body.mass);
        case Target::Kind::spin:
            return 0.1 * trace * kTypicalFrequency;
        case Target::Kind::inertia:
            return 0.1 * trace;
        case Target::Kind::mode:
            return modeScale(model, target, name);
        case Target::Kind::load:
            return 1.0;
        case Target::Kind::sensor:
            return target.parameter == "gain" ? 1.0 : 1e-3;
        case Target::Kind::sensor_rotation:
            return 0.01;
    }
    failName(name, "not the name of a parameter");
}

}  // namespace wems
