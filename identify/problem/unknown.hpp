/// @file
/// The unknowns of a test: every number of the model and of its sensors as a typed row, with what is believed of it.
///
/// A row has a tolerance (prior standard deviation, 0 = exactly known), within which a number is adjusted, and a reach,
/// the standard deviation that it has where a hypothesis sets it free.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "identify/problem/sensor_layout.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

/// A model together with what its sensors have wrong.
struct TestState {
    MountModel model;
    SensorErrors sensors;
};

/// What a row is a number of, which tells how a change of it acts.
enum class UnknownKind {
    law,           ///< of one axis of a connection
    position,      ///< of a connection, along one axis
    body,          ///< mass, centre of gravity, inertia, spin
    mode,          ///< frequency or damping ratio of a bracket mode
    shape,         ///< of a bracket mode
    load,          ///< gain of one axis of the load (`second`), or of all (3)
    channel_gain,  // from here on of sensors
    channel_delay,
    triax_rotation,
    station_place,
    corner
};

/// Whether it is an error of what measures, not of the device.
constexpr bool isOfSensor(UnknownKind kind) {
    return kind >= UnknownKind::channel_gain;
}

struct Unknown {
    UnknownKind kind = UnknownKind::law;
    std::string name;  ///< as results name it: `4.z.+.clearance`, `body.mass`, `mobile.1.az.gain`
    std::string unit;
    double believed = 0;
    double deviation = 0;                 ///< prior standard deviation, half of the tolerance
    double reach = 0;                     ///< standard deviation where set free; > 0
    double step = 0;                      ///< of a finite difference
    double least = -1e300, most = 1e300;  ///< values outside are no answer
    int first = 0;                        ///< connection, mode, channel, triax, station or part
    int second = 0;                       ///< axis or component
    std::function<double(const TestState&)> get;
    std::function<void(TestState&, double)> set;
};

using UnknownTable = std::vector<Unknown>;

/// What scales an unknown that the model has no value of.
struct TestScales {
    double displacement = 0;  ///< m, largest relative displacement of any run
    double velocity = 0;      ///< m/s, likewise
    double lowest = 0;        ///< Hz, lowest excited frequency
    double highest = 0;       ///< Hz
    double duration = 0;      ///< s, of the longest run
};

/// Of x, y and z, whether any run has a load along it.
using LoadedAxes = std::array<bool, 3>;

/// All rows of a model and its sensors. Numbers that only a hypothesis would set free (cubic stiffness, friction, …)
/// have deviation 0.
UnknownTable makeUnknownTable(const TestState& believed, const SensorLayout& layout, const TestScales& scales,
                              const LoadedAxes& loaded);

/// Index of a name; -1 if there is none.
int findUnknown(const UnknownTable& table, const std::string& name);

}  // namespace wems::identify
