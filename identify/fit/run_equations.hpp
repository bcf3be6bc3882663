/// @file
/// The equations of one run as fitMount() sets them up, and the solution of those of several runs.
#pragma once

#include "identify/fit/equation_of_motion.hpp"
#include "identify/fit/fit.hpp"

namespace wems::identify {

/// Test function as the options say, or chosen from the run's channels and rate.
/// @throws InputError if the run is too short
RunEquations makeRunEquations(const RunMotion& run, const MountModel& model, const FitOptions& options);

/// The rest of fitMount(): all parameters from the equations of all runs.
/// @param runs of a run of which no scatter of gains was noticed (hasGainScatter), noise levels and times suffice
FitResult solveEquations(const std::vector<RunMotion>& runs, std::vector<RunEquations> equations,
                         const MountModel& model, const FitOptions& options);

}  // namespace wems::identify
