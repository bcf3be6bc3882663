/// @file
/// Numbers that adjustments carried beyond their tolerance, where the evidence would rather have them free: which of
/// them are causes.
#pragma once

#include <map>
#include <vector>

#include "identify/updating/standing.hpp"
#include "identify/verdict/diagnosis.hpp"

namespace wems::identify::updating {

struct NamedNumbers {
    std::map<int, double> beyond;  ///< hypothesis, and the probability that its number lies beyond the tolerance
    std::vector<Decision> decisions;
};

/// Adds one number after another to the causes of a standing, the likeliest first, each if the prediction and the
/// equations bear it out.
/// @param most causes of one answer
NamedNumbers nameNumbers(const TestProblem& problem, const Settler& settler, const FreeJudge& judge, std::size_t most,
                         Standing& standing);

}  // namespace wems::identify::updating
