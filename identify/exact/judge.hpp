/// @file
/// The verdict: errors of free simulations before and after, with and without each cause, and what follows from them.
#pragma once

#include <vector>

#include "identify/exact/channel_faults.hpp"
#include "identify/exact/pass.hpp"
#include "identify/verdict/diagnosis.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

/// Sets verdict, causes, extended model, errors, noise floor and place of what is left of a diagnosis.
/// @param pass             its selection may be made anew, where the simulation asks for it
/// @param identification   the recordings as they are, like `judges`
/// @param faults           of channels, corrected in `pass`
/// @param on_accelerations faults of accelerometers that carry no equation
/// @throws InputError if a simulation is not possible
void judgeBySimulation(Pass& pass, const MountModel& model, const std::vector<Recording>& identification,
                       const std::vector<Recording>& judges, const std::vector<ChannelFault>& faults,
                       const std::vector<ChannelFault>& on_accelerations, Diagnosis& result);

}  // namespace wems::identify
