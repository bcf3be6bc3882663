/// @file
/// Names of parameters taken apart; what models/parameter_access.hpp is built on.
#pragma once

#include <string>
#include <vector>

#include "models/mount_model.hpp"

namespace wems::parameter {

/// What a name refers to.
struct Target {
    enum class Kind { axis, stop, mass, center_of_gravity, inertia, spin, mode, load, sensor, sensor_rotation };
    Kind kind = Kind::axis;
    int connection = 0;
    int index = 0;  // axis, component, or mode from 0; -1: all axes of the load
    Side side = Side::positive;
    std::string parameter;
    std::string channel;
};

/// @throws InputError if the model has no such connection, mode or parameter.
Target parse(const MountModel& model, const std::string& name);

/// The parts of a name between its dots.
std::vector<std::string> split(const std::string& name);

/// The law, and the stop of one side of it (nullptr if there is none), that a target refers to.
template <typename Model>
auto& lawOf(Model& model, const Target& target) {
    return model.connections[target.connection].axis[target.index];
}

template <typename Law>
auto findStop(Law& law, Side side) -> decltype(law.stops.data()) {
    for (auto& stop : law.stops)
        if (stop.side == side) return &stop;
    return nullptr;
}

/// What a stop that is new gets: the stiffness of the model's other stops (first those along the same axis), or
/// ten times the elastomer's; and the mean clearance of the model's stops, or 1 mm.
double newStopStiffness(const MountModel& model, const Target& target);
double typicalClearance(const MountModel& model);

[[noreturn]] void failName(const std::string& name, const std::string& problem);

}  // namespace wems::parameter
