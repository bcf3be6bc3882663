/// @file
/// Fits of displacements alone whose samples do not tell the course of a contact: refined by the equations of motion
/// with the motion between the samples and beyond the low pass as the device itself gives it (fast_motion.hpp).
///
/// The regression of a fit takes a law at the displacement of the samples. Where a period of contact has few of them
/// it errs by many times its own intervals: at 500 Hz and a contact of 134 Hz 481 of 1200 intervals of stops held the
/// truth (identify/VALIDATION.md).
#pragma once

#include <optional>
#include <vector>

#include "identify/fit/fit.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify::updating {

/// Whether all runs are displacements alone and one of them reaches stops between few samples.
bool hasCoarseContacts(const FitResult& fit, const std::vector<RunMotion>& runs);

/// Values, intervals and known combinations anew; what is told apart, and which stops were reached, stays as the fit
/// has it. Nothing where the equations leave no less with other numbers.
/// @param recordings of the runs; @param believed what the fit began with
std::optional<FitResult> refineCoarseContacts(const FitResult& fit, const std::vector<Recording>& recordings,
                                              const MountModel& believed);

}  // namespace wems::identify::updating
