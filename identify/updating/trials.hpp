/// @file
/// The best few sets of a round where numbers have tolerances, each judged where its estimate leads.
#pragma once

#include <vector>

#include "identify/updating/settling.hpp"

namespace wems::identify::updating {

/// Sets of a round that are judged where they lead.
inline constexpr std::size_t kTried = 8;

/// A set, where its estimate leads, and what the equations really say there.
struct Trial {
    HypothesisSet set;
    TestPoint point;
    double log_evidence = 0;  ///< of the quadratic, less half of what the misfit exceeds the quadratic's by
};

/// The present set, then the best few by the quadratic: laws and sensors are not of first order.
/// @param present with the view that `evidence` is of
/// @param ranked candidates by the quadratic, the best first
std::vector<Trial> tryBest(TestProblem& problem, const Settler& settler, const SetState& present,
                           const Evidence& evidence, const std::vector<RankedSet>& ranked);

}  // namespace wems::identify::updating
