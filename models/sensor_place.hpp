/// @file
/// Sensors that do not sit at a connection along the mount axes: where they are and which way they look.
///
/// In a model, or in a file of its own (`--geometry`), a table for each sensor:
///
///     [[accelerometer]]                    # or [[marker]], for displacements and velocities
///     name = "A3"                          # channels mobile.A3.ax, .ay, .az (marker: .x, .y, .z, .vx …)
///     part = "mobile"                      # or "fixed"
///     position = [0.05, 0.02, 0.30]        # m, in the part's frame
///     rotation = [0.0, 0.0, 0.785]         # rotation vector, rad, that turns the part's axes into the sensor's;
///                                          # absent = none
///     noise = 0.02                         # RMS of one channel (m, or m/s^2), for the weights; absent = as the others
///     channels = { x = "CH 4", z = "CH 5" } # the recording's names of its axes; absent = they are called as above
///
/// A marker is seen from outside: its axes stay where they are at rest. An accelerometer is strapped to its part: its
/// axes turn with it. Its channel is the acceleration of that point along its axis, without gravity (what an AC-coupled
/// sensor gives). One axis alone counts too.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "models/recording/column_map.hpp"
#include "models/recording/recording.hpp"

namespace wems {

struct SensorPlace {
    std::string name;
    Part part = Part::mobile;
    bool accelerometer = true;  ///< false: a marker
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Vector3d rotation = Eigen::Vector3d::Zero();
    double noise = 0;                    ///< 0: not stated
    std::array<std::string, 3> columns;  ///< of x, y, z in the recording; empty: the channel's own name

    bool measures(Derivative derivative) const {
        return accelerometer == (derivative == Derivative::acceleration) && derivative != Derivative::force;
    }
    /// Direction of a sensor axis in the part's axes, at rest.
    Eigen::Vector3d direction(int axis) const;
    std::string channelName(int axis) const;
};

/// Reads a file of nothing but such tables. @throws InputError with file, line and key.
std::vector<SensorPlace> readSensorPlaces(const std::string& file);

/// Adds the columns that the places name to `map`. @throws InputError if the map gives one of their channels already.
void addColumns(const std::vector<SensorPlace>& places, ColumnMap& map);

}  // namespace wems
