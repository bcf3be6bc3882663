/// @file
/// Free simulations of a group of runs, and what noise and the posterior of all unknowns allow them to err.
#pragma once

#include <string>
#include <vector>

#include "identify/updating/selection.hpp"
#include "identify/verdict/free_error.hpp"

namespace wems::identify::updating {

/// Relative error below which the next draw of the unknowns lies with a probability of 95 %: model parameters from the
/// posterior, simulated; what the sensors have wrong, which is corrected neither in what is compared nor in the motion
/// that drives; and noise.
/// @param point, posterior about which the draws lie
/// @param first index of the first of `runs` among the problem's
/// @param seed of the draws, so that a result is the same again
double calcPredictionBand(const TestProblem& problem, const HypothesisSet& set, const TestPoint& point,
                          const Posterior& posterior, const std::vector<FreeRun>& runs, std::size_t first,
                          double noise_floor, unsigned seed);

// Where a residual sits that no cause explains.

/// A force of any history at one axis of one connection has a known direction in the six equations: the share of the
/// residual that lies along it tells the place without knowing the law. Returns the axes (`1.x`) that carry the mount's
/// residual at a view, or `bracket`, followed by the regime that it belongs to: `free`, `contact`, or both.
std::vector<std::string> locateRemainder(const TestView& view, const std::vector<double>& misfit,
                                         const MountModel& model);

/// Misfit of the mount's equation per value over frequency, of the runs from the one with index `first` on.
MisfitSpectrum calcMisfitSpectrum(const TestView& before, const TestView& after, std::size_t first);

}  // namespace wems::identify::updating
