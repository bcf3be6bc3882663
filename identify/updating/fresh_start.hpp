/// @file
/// Where the adjusted numbers of an axis lie far beyond their tolerances, a number that moves its stops may be what
/// they stand for. Steps from there do not find it: the way back leads over what the numbers made up for.
#pragma once

#include <vector>

#include "identify/updating/settling.hpp"
#include "identify/updating/trials.hpp"

namespace wems::identify::updating {

/// Of each such cause the best place to begin: the numbers of its axis as believed, its own number where it was probed.
/// None where nothing is stretched, or where no cause leaves less than the believed numbers alone.
/// @param present what a cause is added to
/// @param best the likeliest set so far, or the present one: numbers that it frees are not stretched, but for those
/// that it frees one by one, as the clearances of both sides, for which one number may stand
std::vector<Trial> startAfresh(const TestProblem& problem, const Settler& settler, const SetState& present,
                               const SetState& best);

}  // namespace wems::identify::updating
