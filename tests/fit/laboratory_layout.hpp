/// @file
/// A laboratory's own sensors on a run with a known truth.
#pragma once

#include <cstdint>
#include <vector>

#include "models/sensor_place.hpp"
#include "tests/fit/synthetic_run.hpp"

namespace wems::test {

/// Sensors away from the connections, turned, some with one axis: on each part three markers and three accelerometers
/// of three axes, and two accelerometers of one.
std::vector<SensorPlace> makeLayout(std::uint64_t seed);

/// Channels of these sensors, white Gaussian noise added.
Recording recordLayout(const SyntheticRun& run, const std::vector<SensorPlace>& places, const SensorNoise& noise,
                       std::uint64_t seed);

}  // namespace wems::test
