/// @file
/// The tables [[marker]] and [[accelerometer]] of a TOML file.
#pragma once

#include <vector>

#include "models/sensor_place.hpp"
#include "models/toml_table.hpp"

namespace wems {

/// Appends those of `root`. @throws InputError
void readSensorTables(TomlTable& root, std::vector<SensorPlace>& places);

}  // namespace wems
