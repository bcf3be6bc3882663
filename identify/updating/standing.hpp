/// @file
/// Where a search for causes stands between its rounds, with exact numbers or with tolerances.
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "identify/updating/settling.hpp"
#include "identify/verdict/free_error.hpp"

namespace wems::identify::updating {

/// Log evidence, 150 to one: what lies so far below the present set is not tried, with exact numbers or with
/// tolerances, nor is it a rival of the best; a larger set so far above it is asked for, a number beyond its tolerance
/// that others could make up for has a name, and a cause that makes such numbers needless is needed. Other values were
/// not tried.
inline constexpr double kUnlikely = 5;

/// Free simulation of the runs that judge, without the faults of sensors that the set names.
using FreeJudge = std::function<FreeError(const TestPoint&, const HypothesisSet&)>;

/// Error of that simulation that noise and what the numbers of a state leave open allow, 95 %.
using BandJudge = std::function<double(const SetState&, const Posterior&)>;

/// What becomes of a set that was fitted, and of one that is not the likeliest.
inline const char* const kTaken = "taken";
inline const char* const kLessLikely = "less likely";
inline const char* const kImpossible = "its numbers cannot be";
inline const char* const kWithin = "its numbers lie within their tolerances";
inline const char* const kSpoils = "the prediction is worse with it";

/// Where a search stands: the causes so far, what the simulation makes of them, and the sets that were weighed last.
struct Standing {
    SetState state;
    FreeError judged;
    std::vector<RankedSet> ranked;
    std::map<HypothesisSet, TestPoint> settled;  ///< where sets were settled that are no more than ranked
};

}  // namespace wems::identify::updating
