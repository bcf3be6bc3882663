/// @file
/// Model updating with causes: every number of the model and of its sensors may lie anywhere within its tolerance, and
/// what lies beyond it, or is a mechanism that the model lacks, is a cause.
///
/// Order of the argument: (1) the equations of motion of mount and bracket along the measured motion, and the
/// consistency of each rigid part's channels, in units of their noise (identify/problem); (2) every number with its
/// tolerance, and every cause of the catalogue, weighed by the evidence (identify/solve); (3) free simulations before,
/// with the adjustments, and after, against a band that noise and posterior allow.
#pragma once

#include <vector>

#include "identify/updating/test_problem.hpp"
#include "identify/verdict/diagnosis.hpp"

namespace wems::identify::updating {

/// @param validation runs that judge; empty: the identification runs do
/// @throws InputError if the motion cannot be recovered or a simulation is not possible
Diagnosis updateModel(const std::vector<Recording>& identification, const std::vector<Recording>& validation,
                      const MountModel& model, Numbers numbers, const DiagnosisOptions& options);

}  // namespace wems::identify::updating
