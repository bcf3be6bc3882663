/// @file
/// What the noise of a recorded drive makes of a free simulation.
///
/// A recorded load, base acceleration or motion of the fixed part drives with its noise, and contact may amplify it: of
/// two recordings of one random run against a hard stop, each with 2 µm and 0.02 m/s² of noise, the exact model then
/// leaves a tenth. Simulations of the drive with a second draw of such noise say how much. Of a motion that is
/// integrated from an accelerometer the noise is also in the displacements that a simulation is compared with, far
/// larger than what a mount makes of it.
#pragma once

#include "identify/verdict/free_error.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

/// Mean square, m², over connections, axes and samples of what a further draw of the drive's noise changes of a run's
/// simulated relative displacements against the measured ones, and the deviation of a draw from it. The noise has the
/// spectrum that `run.drive` says, and is drawn where the mount answers: harmonics of random phase up to twice the
/// frequency that it is excited to. Draws that diverge are left out, as they have no size; 0 where the model itself
/// diverges, whose error is infinite then.
/// @param seed the same one gives the same draws
DrivenNoise calcDrivenNoise(const FreeRun& run, const MountModel& model, unsigned seed);

}  // namespace wems::identify
