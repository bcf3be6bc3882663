/// @file
/// A first look at every candidate: how much of the residual would it take away, and with what values?
#pragma once

#include <cstddef>
#include <vector>

#include "identify/diagnose/catalogue.hpp"
#include "identify/diagnose/law_differences.hpp"
#include "identify/diagnose/open_loop_problem.hpp"

namespace wems::identify {

/// A candidate with the values that one step of linear least squares gives.
struct Screened {
    std::size_t candidate = 0;   ///< index in the list
    std::vector<double> values;  ///< of its knobs
    double gain = 0;             ///< decrease of the sum of squares that linearisation promises
};

/// The best start of each candidate, to first order in rotations, sorted by falling gain less `price` for each knob.
/// Uses two threads.
std::vector<Screened> screenCandidates(const OpenLoopProblem& problem, LawDifferences& laws, const MountModel& model,
                                       const WhiteVector& residual, const std::vector<Candidate>& candidates,
                                       double price);

}  // namespace wems::identify
