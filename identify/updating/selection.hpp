/// @file
/// Which causes the recordings speak for: rounds of linearisation, search by evidence, and moving to the best estimate.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "identify/updating/standing.hpp"
#include "identify/verdict/diagnosis.hpp"

namespace wems::identify::updating {

struct Selection {
    SetState state;                              ///< with the causes, by the identification runs
    TestPoint adjusted;                          ///< with adjustments alone
    std::vector<RankedSet> ranked;               ///< at the last linearisation, all runs together
    std::map<HypothesisSet, TestPoint> settled;  ///< of those among exact numbers, where each was settled
    Posterior posterior;                         ///< of the identification runs
    TestPoint fitted;                            ///< of all runs together
    /// Of all runs, and of the identification runs, as the noise alone would have it.
    Posterior fitted_noise, noise;
    std::vector<Decision> decisions;
    std::vector<ElasticLaw> elastic_laws;  ///< of a cause that was taken back
    /// Of causes that are numbers found beyond their tolerance: the probability that they are.
    std::map<int, double> beyond;
    bool asks_for_more = false;  ///< exact numbers, though there are tolerances, would need more causes

    /// Probability of a hypothesis: that it lies beyond its tolerance, or over the ranked sets.
    double probabilityOf(int hypothesis) const;
};

/// @param progress may be empty
/// @param band may be empty: then predictions count as known
Selection selectCauses(TestProblem& problem, const FreeJudge& judge, const BandJudge& band,
                       const ProgressListener& progress);

}  // namespace wems::identify::updating
