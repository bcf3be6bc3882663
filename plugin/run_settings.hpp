/// @file
/// A run as its options ask for it.
#pragma once

#include <string>
#include <vector>

#include "models/result/result_record.hpp"
#include "plugin/simulate_options.hpp"
#include "plugin/simulation.hpp"

namespace wems::plugin {

/// Times, channels, noise, accuracy and longest step.
SimulationSettings makeSettings(const SimulateOptions& options, const Excitation& excitation);

/// Names and units of the channels, and what the recording says of the run.
Recording makeHeader(const SimulateOptions& options, const MountModel& model, const Excitation& excitation,
                     const std::vector<SensorChannel>& channels);

/// What a result rests on: the model with its bracket modes, the file of the excitation or the recording that is
/// replayed, and the options with their defaults, SI units.
/// @param command that answers: simulate, modes or response
/// @param in_memory the model is no file
ResultRecord makeRecord(const SimulateOptions& options, const std::string& command, const MountModel& model,
                        bool in_memory = false);

}  // namespace wems::plugin
