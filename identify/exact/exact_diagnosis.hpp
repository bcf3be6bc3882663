/// @file
/// A diagnosis in which every number of the model and of the sensors is exactly known but for the causes.
///
/// Order of the argument: (1) the measurement, by the consistency of each rigid part's channels; (2) the equations of
/// motion of mount and bracket along the measured motion (open loop: nothing chaotic enters), whitened by the noise
/// that the recordings themselves show; (3) every cause of the catalogue at every place, fitted jointly with those
/// already accepted and judged on the validation runs; (4) free simulations before and after.
#pragma once

#include <vector>

#include "identify/verdict/diagnosis.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

/// @param validation runs that judge; empty: the identification runs do
/// @throws InputError if the motion cannot be recovered or a simulation is not possible
Diagnosis diagnoseExact(const std::vector<Recording>& identification, const std::vector<Recording>& validation,
                        const MountModel& model, const DiagnosisOptions& options);

}  // namespace wems::identify
