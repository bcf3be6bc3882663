/// @file
/// The equations of one run as fitMount() sets them up.
#pragma once

#include "identify/fit/equation_of_motion.hpp"
#include "identify/fit/fit.hpp"

namespace wems::identify {

/// Test function as the options say, or chosen from the run's channels and rate.
/// @throws InputError if the run is too short
RunEquations makeRunEquations(const RunMotion& run, const MountModel& model, const FitOptions& options);

}  // namespace wems::identify
