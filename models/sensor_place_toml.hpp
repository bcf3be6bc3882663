/// @file
/// The tables [[marker]] and [[accelerometer]] of a TOML file.
#pragma once

#include <vector>

#include "models/common/toml_table.hpp"
#include "models/sensor_place.hpp"

namespace wems {

/// Appends those of `root`. @throws InputError
void readSensorTables(TomlTable& root, std::vector<SensorPlace>& places);

}  // namespace wems
