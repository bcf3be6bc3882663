/// @file
/// A structural mode that the modes file lacks, as a candidate: frequency, damping ratio and shape.
#pragma once

#include <vector>

#include "identify/diagnose/catalogue.hpp"
#include "identify/diagnose/open_loop_problem.hpp"

namespace wems::identify {

/// One candidate with the best few starts that a scan of the bracket's residual gives; none where the bracket's
/// equation leaves no more than noise, or no mode takes anything away.
///
/// Where the load point of all the model's modes moves rigidly with the interface, that of the new one does, and its
/// shape has six unknowns; otherwise the participation in each direction of the load is one more, as is that of each
/// direction in which the base was driven. Directions in which nothing acted are not determined: the load point then
/// moves as it would were it rigid, the base does not drive the mode.
std::vector<Candidate> makeMissingMode(const OpenLoopProblem& problem, const MountModel& model,
                                       const WhiteVector& residual);

}  // namespace wems::identify
