/// @file
/// A run as its options ask for it.
#pragma once

#include <vector>

#include "plugin/simulate_options.hpp"
#include "plugin/simulation.hpp"

namespace wems::plugin {

/// Times, channels, noise, accuracy and longest step.
SimulationSettings makeSettings(const SimulateOptions& options, const Excitation& excitation);

/// Names and units of the channels, and what the recording says of the run.
Recording makeHeader(const SimulateOptions& options, const MountModel& model, const Excitation& excitation,
                     const std::vector<SensorChannel>& channels);

}  // namespace wems::plugin
