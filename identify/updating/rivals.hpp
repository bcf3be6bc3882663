/// @file
/// Rivals of a set of causes that were weighed in earlier rounds of a search. About a state that has the set they are
/// far from what they would be by themselves, so that a later round cannot weigh them again.
#pragma once

#include <vector>

#include "identify/updating/standing.hpp"

namespace wems::identify::updating {

/// Adds the rivals of the present set from the round that took it to those of a round that takes nothing.
void keepRivals(const Standing& standing, std::vector<RankedSet>& ranked);

/// Adds the rivals of the present set, each with what the next one adds to it, to those of the round that takes the
/// next one: how likely one is over the other is as it was. Where they were settled is kept with them.
void carryRivals(Standing& standing, const HypothesisSet& next, std::vector<RankedSet>& ranked);

/// Adds sets that were weighed against the present one and found less likely, by as much as they are so.
/// @param weight of the present set where they were weighed
/// @param[in,out] ranked stays as it is without the present set
void addLessLikely(const HypothesisSet& present, double weight, const std::vector<RankedSet>& others,
                   std::vector<RankedSet>& ranked);

}  // namespace wems::identify::updating
