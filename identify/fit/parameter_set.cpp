#include "identify/fit/parameter_set.hpp"

#include <algorithm>
#include <cmath>

#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/common/units.hpp"
#include "models/parameter_access.hpp"

namespace wems::identify {
namespace {

const AxisLaw& lawOf(const MountModel& model, int connection, int axis) {
    return model.connections.at(connection).axis.at(axis);
}

void addBodyParameters(const std::string& wanted, std::vector<Parameter>& parameters) {
    bool found = false;
    const auto addIf = [&](ParameterKind kind, const std::string& group, const std::string& component, int index) {
        const std::string name = group + "." + component;
        if (wanted != group && wanted != name) return;
        found = true;
        const bool there = std::any_of(parameters.begin(), parameters.end(),
                                       [&](const Parameter& other) { return other.name == name; });
        if (!there) parameters.push_back({kind, name, parameterUnit(name), -1, index, -1});
    };
    for (int j = 0; j < 3; ++j) addIf(ParameterKind::center_of_gravity, "body.center_of_gravity", kAxes[j], j);
    for (int j = 0; j < 6; ++j) addIf(ParameterKind::inertia, "body.inertia", kInertiaNames[j], j);
    if (found) return;
    if (wanted == "body.mass")
        throw InputError({{}, 0, "--free body.mass"},
                         "motion alone cannot tell the mass: it and all stiffnesses scale together; weigh it");
    throw InputError({{}, 0, "--free " + wanted}, "not a parameter that can be freed",
                     "body.center_of_gravity, body.inertia, or one component such as body.center_of_gravity.z, "
                     "body.inertia.Ixx");
}

/// Damping that a lightly damped elastomer would have: what a dashpot without a model value is measured against.
double referenceDamping(double stiffness) {
    constexpr double damping_ratio = 0.01, frequency = 30;  // -, Hz
    return 2 * damping_ratio * stiffness / (kTwoPi * frequency);
}

}  // namespace

std::string formatAxisName(const MountModel& model, int connection, int axis) {
    return model.connections.at(connection).name + "." + kAxes[axis];
}

std::vector<Parameter> makeParameters(const MountModel& model, const std::vector<std::string>& free_body) {
    std::vector<Parameter> parameters;
    const int count = static_cast<int>(model.connections.size());
    const auto addAxisParameters = [&](ParameterKind kind, const char* what) {
        for (int i = 0; i < count; ++i)
            for (int a = 0; a < 3; ++a) {
                if (lawOf(model, i, a).stiffness <= 0) continue;
                const std::string name = formatAxisName(model, i, a) + what;
                parameters.push_back({kind, name, parameterUnit(name), i, a, -1});
            }
    };
    const auto addStopParameters = [&](ParameterKind kind, const char* what) {
        for (int i = 0; i < count; ++i)
            for (int a = 0; a < 3; ++a) {
                const auto& stops = lawOf(model, i, a).stops;
                for (auto stop = stops.begin(); stop != stops.end(); ++stop) {
                    const auto same_side = [&](const Stop& other) { return other.side == stop->side; };
                    if (std::any_of(stops.begin(), stop, same_side)) continue;
                    const std::string name =
                        formatAxisName(model, i, a) + (stop->side == Side::positive ? ".+" : ".-") + what;
                    parameters.push_back(
                        {kind, name, parameterUnit(name), i, a, static_cast<int>(stop - stops.begin())});
                }
            }
    };
    addAxisParameters(ParameterKind::stiffness, ".stiffness");
    addAxisParameters(ParameterKind::damping, ".damping");
    addStopParameters(ParameterKind::clearance, ".clearance");
    addStopParameters(ParameterKind::stop_stiffness, ".stiffness");
    for (const auto& wanted : free_body) addBodyParameters(wanted, parameters);
    return parameters;
}

std::vector<Parameter> makeAnyParameters(const MountModel& model, const std::vector<std::string>& free) {
    std::vector<std::string> of_body, others;
    for (const std::string& name : free) {
        const bool grouped = name.rfind("body.center_of_gravity", 0) == 0 || name.rfind("body.inertia", 0) == 0;
        (grouped ? of_body : others).push_back(name);
    }
    std::vector<Parameter> parameters = makeParameters(model, of_body);
    for (const std::string& name : others) {
        try {
            getParameter(model, name);
        } catch (const InputError& error) {
            throw InputError({{}, 0, "--free " + name}, error.problem(), error.accepted());
        }
        if (std::none_of(parameters.begin(), parameters.end(),
                         [&](const Parameter& other) { return other.name == name; }))
            parameters.push_back({ParameterKind::other, name, parameterUnit(name), -1, -1, -1});
    }
    return parameters;
}

double calcScale(const MountModel& model, const Parameter& parameter) {
    const double value = std::abs(getParameter(model, parameter.name));
    switch (parameter.kind) {
        case ParameterKind::damping:
            return std::max(value, referenceDamping(lawOf(model, parameter.connection, parameter.axis).stiffness));
        case ParameterKind::center_of_gravity: {
            double size = 0;  // of the mount
            for (const auto& connection : model.connections) size = std::max(size, connection.position.norm());
            return size > 0 ? size : std::max(value, 1.0);
        }
        case ParameterKind::inertia:
            return model.body.inertia.trace() / 3;
        default:
            return value > 0 ? value : 1.0;
    }
}

}  // namespace wems::identify
