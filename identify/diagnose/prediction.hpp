/// @file
/// Free simulations of a group of runs, and what noise and the posterior of all unknowns allow them to err.
#pragma once

#include <vector>

#include "identify/diagnose/free_error.hpp"
#include "identify/diagnose/selection.hpp"

namespace wems::identify {

/// Runs with what they are compared with. @param recordings as measured
std::vector<FreeRun> prepareFreeRuns(const std::vector<Recording>& recordings,
                                     const std::vector<const RunMotion*>& motions, const MountModel& model);

/// Relative error below which 95 of 100 draws of the unknowns lie: model parameters from the posterior, simulated;
/// gains and directions of sensors, which are not corrected in what is compared; and noise.
/// @param seed of the draws, so that a result is the same again
double calcPredictionBand(const TestProblem& problem, const Selection& selection, const std::vector<FreeRun>& runs,
                          double noise_floor, unsigned seed);

}  // namespace wems::identify
