/// @file
/// What the noise of a recorded drive makes of a free simulation.
///
/// A recorded load, base acceleration or motion of the fixed part drives with its noise, and contact may amplify it: of
/// two recordings of one random run against a hard stop, each with 2 µm and 0.02 m/s² of noise, the exact model then
/// leaves a tenth. Simulations of the drive with a second draw of such noise say how much.
#pragma once

#include "identify/verdict/free_error.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

/// Mean square, m², over connections, axes and samples of what a further draw of the drive's noise changes of a run's
/// simulated relative displacements. The noise is white in the recording, of the size that `run.drive` says, and is
/// drawn where the mount answers: harmonics of random phase up to twice the frequency that it is excited to. Draws that
/// diverge are left out, as they have no size; 0 where the model itself diverges, whose error is infinite then.
/// @param seed the same one gives the same draws
double calcDrivenVariance(const FreeRun& run, const MountModel& model, unsigned seed);

}  // namespace wems::identify
