/// @file
/// Sensors whose faults the model states already: the recordings are corrected by them before anything is sought, and
/// what is found is added to them afterwards.
#pragma once

#include <vector>

#include "identify/verdict/diagnosis.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

/// The model whose sensors keep their tolerances, but no faults.
MountModel withoutFaults(MountModel model);

/// Turns a diagnosis of corrected recordings into one of those that were made: of each number of a sensor what the
/// channel makes of the truth in all, and the sensors of the extended model alike. To first order in the interval.
/// @param recordings as they were made; their channels tell what a number of a group is about
void addBelievedSensors(const std::vector<SensorFault>& believed, const std::vector<Recording>& recordings,
                        Diagnosis& diagnosis);

}  // namespace wems::identify
