/// @file
/// The recording that a model would have given: the drive of a measured run, noise and calibration of its size.
#pragma once

#include "identify/motion/motion.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

struct SimulatedNoise {
    double sign = 1;          ///< of the noise that the run shows, ±1: the same draw with both signs; 0 for none
    double gain_scatter = 0;  ///< standard deviation of each channel's gain, the load's included
};

/// What `model` would have given at all its connections, of the kinds that were recorded, at the times of `run`.
/// Motions of `run` are its own, so that faults of channels, which were corrected, do not return.
/// @throws SimulationDiverged
Recording simulateRecording(const RunMotion& run, const MountModel& model, const SimulatedNoise& noise);

}  // namespace wems::identify
