/// @file
/// Free simulations of a group of runs, and what noise and the posterior of all unknowns allow them to err.
#pragma once

#include <vector>

#include "identify/diagnose/free_error.hpp"
#include "identify/updating/selection.hpp"

namespace wems::identify::updating {

/// Relative error below which 95 of 100 draws of the unknowns lie: model parameters from the posterior, simulated; what
/// the sensors have wrong, which is corrected neither in what is compared nor in the motion that drives; and noise.
/// @param point, posterior about which the draws lie
/// @param first index of the first of `runs` among the problem's
/// @param seed of the draws, so that a result is the same again
double calcPredictionBand(const TestProblem& problem, const HypothesisSet& set, const TestPoint& point,
                          const Posterior& posterior, const std::vector<FreeRun>& runs, std::size_t first,
                          double noise_floor, unsigned seed);

}  // namespace wems::identify::updating
