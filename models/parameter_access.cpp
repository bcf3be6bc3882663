#include "models/parameter_access.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "models/axis_numbers.hpp"
#include "models/parameter_name.hpp"

namespace wems {

using namespace parameter;
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNewTimeConstant = 0.01;  // s, in the middle of 5–50 Hz

std::pair<int, int> inertiaEntry(int index) {
    constexpr int kRow[6] = {0, 1, 2, 0, 0, 1}, kColumn[6] = {0, 1, 2, 1, 2, 2};
    return {kRow[index], kColumn[index]};
}

/// The numbers of a hysteresis by their names; nullptr if it is none of them.
double Hysteresis::*findHysteresisNumber(const std::string& parameter) {
    if (parameter == "hysteresis_force") return &Hysteresis::force;
    if (parameter == "yield_displacement") return &Hysteresis::yield_displacement;
    if (parameter == "exponent") return &Hysteresis::exponent;
    return parameter == "shape" ? &Hysteresis::shape : nullptr;
}

double getAxis(const AxisLaw& law, const Target& target, const std::string& name) {
    const auto& p = target.parameter;
    if (const AxisNumber* number = findAxisNumber(p)) return law.*number->member;
    if (const auto member = findHysteresisNumber(p)) return law.hysteresis.value_or(Hysteresis{}).*member;
    if (p == "stiffness_ratio") return law.relaxation ? law.relaxation->stiffness_ratio : 0.0;
    if (p == "time_constant") return law.relaxation ? law.relaxation->time_constant : kNewTimeConstant;
    if (p == "friction_force") return law.friction ? law.friction->force : 0.0;
    if (p == "transition_velocity") return (law.friction ? *law.friction : Friction{}).transition_velocity;
    if (p == "presliding_stiffness")
        return law.friction && law.friction->presliding_stiffness ? *law.friction->presliding_stiffness : kInfinity;
    if (p == "dissipation") {
        double sum = 0;
        for (const auto& stop : law.stops) sum += stop.dissipation;
        return law.stops.empty() ? 0.0 : sum / static_cast<double>(law.stops.size());
    }
    failName(name, "an axis has no parameter '" + p + "'");
}

void setAxis(AxisLaw& law, const Target& target, const std::string& name, double value) {
    const auto& p = target.parameter;
    const auto relaxation = [&]() -> Relaxation& {
        if (!law.relaxation) law.relaxation = Relaxation{0.0, kNewTimeConstant};
        return *law.relaxation;
    };
    const auto friction = [&]() -> Friction& {
        if (!law.friction) law.friction = Friction{};
        return *law.friction;
    };
    if (const AxisNumber* number = findAxisNumber(p)) {
        law.*number->member = value;
    } else if (const auto member = findHysteresisNumber(p)) {
        if (!law.hysteresis) law.hysteresis = Hysteresis{};
        (*law.hysteresis).*member = value;
    } else if (p == "stiffness_ratio") {
        relaxation().stiffness_ratio = value;
    } else if (p == "time_constant") {
        relaxation().time_constant = value;
    } else if (p == "friction_force") {
        friction().force = value;
    } else if (p == "transition_velocity") {
        friction().transition_velocity = value;
    } else if (p == "presliding_stiffness") {
        friction().presliding_stiffness = std::isfinite(value) ? std::optional<double>(value) : std::nullopt;
    } else if (p == "dissipation") {
        for (auto& stop : law.stops) stop.dissipation = value;
    } else {
        failName(name, "an axis has no parameter '" + p + "'");
    }
}

double getStop(const AxisLaw& law, const Target& target, const std::string& name) {
    const Stop* stop = findStop(law, target.side);
    if (target.parameter == "clearance") return stop ? stop->clearance : kInfinity;
    if (target.parameter == "stiffness") return stop ? stop->stiffness : 0.0;
    if (target.parameter == "dissipation") return stop ? stop->dissipation : 0.0;
    failName(name, "a stop has clearance, stiffness and dissipation only");
}

void setStop(MountModel& model, const Target& target, const std::string& name, double value) {
    auto& law = lawOf(model, target);
    if (target.parameter == "clearance" && !std::isfinite(value)) {
        law.stops.erase(std::remove_if(law.stops.begin(), law.stops.end(),
                                       [&](const Stop& stop) { return stop.side == target.side; }),
                        law.stops.end());
        return;
    }
    Stop* stop = findStop(law, target.side);
    if (stop == nullptr) {
        const double stiffness = newStopStiffness(model, target);
        law.stops.push_back({target.side, typicalClearance(model), stiffness, 0.0});
        stop = &law.stops.back();
    }
    if (target.parameter == "clearance") {
        stop->clearance = value;
    } else if (target.parameter == "stiffness") {
        stop->stiffness = value;
    } else if (target.parameter == "dissipation") {
        stop->dissipation = value;
    } else {
        failName(name, "a stop has clearance, stiffness and dissipation only");
    }
}

/// Value of a bracket mode; what a name may say was checked when it was taken apart.
double& modeEntry(BracketMode& mode, const std::string& parameter) {
    if (parameter == "frequency") return mode.frequency;
    if (parameter == "damping_ratio") return mode.damping_ratio;
    const Eigen::Index component = parameter.back() - 'x';
    if (parameter.rfind("load.", 0) == 0) return mode.load_translation[component];
    if (parameter.rfind("base.", 0) == 0) return mode.base_participation[component];
    return (parameter[0] == 'u' ? mode.translation : mode.rotation)[component];
}

/// Gain, delay or zero; what a name may say was checked when it was taken apart.
template <typename Fault>
auto& numberOf(Fault& fault, const std::string& parameter) {
    if (parameter == "gain") return fault.gain;
    return parameter == "delay" ? fault.delay : fault.zero;
}

template <typename Sensors>
auto findSensor(Sensors& sensors, const std::string& channel) -> decltype(sensors.data()) {
    for (auto& sensor : sensors)
        if (sensor.channel == channel) return &sensor;
    return nullptr;
}

}  // namespace

double getParameter(const MountModel& model, const std::string& name) {
    const auto target = parse(model, name);
    switch (target.kind) {
        case Target::Kind::axis:
            return getAxis(lawOf(model, target), target, name);
        case Target::Kind::stop:
            return getStop(lawOf(model, target), target, name);
        case Target::Kind::mass:
            return model.body.mass;
        case Target::Kind::center_of_gravity:
            return model.body.center_of_gravity[target.index];
        case Target::Kind::spin:
            return model.body.spin[target.index];
        case Target::Kind::inertia: {
            const auto [row, column] = inertiaEntry(target.index);
            return model.body.inertia(row, column);
        }
        case Target::Kind::mode: {
            auto mode = model.bracket[target.index];
            return modeEntry(mode, target.parameter);
        }
        case Target::Kind::load:
            if (target.index >= 0) return model.load ? model.load->axis_gain[target.index] : 1.0;
            return model.load && !model.load->gain_over_frequency.empty()
                       ? model.load->gain_over_frequency.front().second
                       : 1.0;
        case Target::Kind::sensor:
        case Target::Kind::sensor_rotation: {
            const SensorFault* sensor = findSensor(model.sensors, target.channel);
            const SensorFault fault = sensor ? *sensor : SensorFault{};
            if (target.kind == Target::Kind::sensor_rotation) return fault.rotation[target.index];
            return numberOf(fault, target.parameter);
        }
    }
    failName(name, "not the name of a parameter");
}

void setParameter(MountModel& model, const std::string& name, double value) {
    const auto target = parse(model, name);
    switch (target.kind) {
        case Target::Kind::axis:
            setAxis(lawOf(model, target), target, name, value);
            return;
        case Target::Kind::stop:
            setStop(model, target, name, value);
            return;
        case Target::Kind::mass:
            model.body.mass = value;
            return;
        case Target::Kind::center_of_gravity:
            model.body.center_of_gravity[target.index] = value;
            return;
        case Target::Kind::spin:
            model.body.spin[target.index] = value;
            return;
        case Target::Kind::inertia: {
            const auto [row, column] = inertiaEntry(target.index);
            model.body.inertia(row, column) = model.body.inertia(column, row) = value;
            return;
        }
        case Target::Kind::mode: {
            modeEntry(model.bracket[target.index], target.parameter) = value;
            auto& replaced = model.replaced_modes;
            if (std::find(replaced.begin(), replaced.end(), target.index + 1) == replaced.end())
                replaced.push_back(target.index + 1);
            return;
        }
        case Target::Kind::load:
            if (!model.load) model.load = LoadCorrection{{{0.0, 1.0}}};
            if (target.index >= 0)
                model.load->axis_gain[target.index] = value;
            else
                model.load->gain_over_frequency = {{0.0, value}};
            return;
        case Target::Kind::sensor:
        case Target::Kind::sensor_rotation: {
            SensorFault* sensor = findSensor(model.sensors, target.channel);
            if (sensor == nullptr) {
                SensorFault fault;
                fault.channel = target.channel;
                model.sensors.push_back(fault);
                sensor = &model.sensors.back();
            }
            if (target.kind == Target::Kind::sensor_rotation) {
                sensor->rotation[target.index] = value;
            } else {
                numberOf(*sensor, target.parameter) = value;
            }
            return;
        }
    }
}

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
    if (p == "quadratic") return 0.1 * stiffness / kTypicalDisplacement;
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

/// What a channel reads where the device moves by its typical displacement at its typical frequency.
double zeroScale(const MountModel& model, const std::string& channel_name) {
    const auto channel = parseChannelName(channel_name);
    const double rate = !channel                                          ? 1
                        : channel->derivative == Derivative::velocity     ? kTypicalFrequency
                        : channel->derivative == Derivative::acceleration ? kTypicalFrequency * kTypicalFrequency
                        : channel->derivative == Derivative::force        ? typicalStiffness(model, AxisLaw{})
                                                                          : 1;
    return rate * kTypicalDisplacement;
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
    if (p == "zero") {
        const auto channel = parseChannelName(name.substr(0, name.rfind('.')));
        return channel ? siUnit(findQuantity(*channel)) : "-";
    }
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
            if (target.parameter == "gain") return 1.0;
            return target.parameter == "delay" ? 1e-3 : zeroScale(model, target.channel);
        case Target::Kind::sensor_rotation:
            return 0.01;
    }
    failName(name, "not the name of a parameter");
}

}  // namespace wems
