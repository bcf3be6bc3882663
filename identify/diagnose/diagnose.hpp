/// @file
/// What the simulation gets wrong: from recordings and a model to named causes, an extended model and its gain.
///
/// The simplest world first: exact numbers and a cause or two (identify/exact). Where that leaves something, every
/// number may lie anywhere within its tolerance (identify/updating). Of two answers that leave something, the one that
/// satisfies the equations of motion, else the one that predicts better.
#pragma once

#include <vector>

#include "identify/verdict/diagnosis.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

/// @param validation runs that judge; empty: the identification runs do, which `validated` says
/// @throws InputError if the motion cannot be recovered or a simulation is not possible
Diagnosis diagnose(const std::vector<Recording>& identification, const std::vector<Recording>& validation,
                   const MountModel& model, const DiagnosisOptions& options = {});

}  // namespace wems::identify
