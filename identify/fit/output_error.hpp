/// @file
/// Fit by simulation (output error: Ljung 1999, ch. 7; Schoukens and Ljung 2019, doi:10.1109/MCS.2019.2938121): the
/// numbers with which free simulations of the model meet the recorded relative displacements.
///
/// The equations of motion (fit.hpp) need accelerations and velocities. Displacements alone with few samples in a
/// period do not hold them, but they still are what the device did. The price is a simulation for each derivative, and
/// a start that is near enough: each run follows the model over its whole length.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "identify/fit/fit.hpp"
#include "identify/motion/motion.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

/// Numbers: those of makeAnyParameters, the zeros of `channels` (displacements of the mobile part that were recorded)
/// and of each load axis that acts. Runs are weighted by what they leave, which makes it the most likely solution for
/// noise of unknown size in each.
/// @param report called before each step with its number from 1 and the error so far, over the motion
/// @throws InputError without runs, without displacements, on a name of nothing, or if the model cannot be simulated
FitResult fitBySimulation(const std::vector<RunMotion>& runs, const MountModel& model, const FitOptions& options,
                          const std::vector<std::string>& channels,
                          const std::function<void(int step, double error)>& report = {});

}  // namespace wems::identify
