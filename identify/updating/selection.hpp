/// @file
/// Which causes the recordings speak for: rounds of linearisation, search by evidence, and moving to the best estimate.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "identify/diagnose/diagnosis.hpp"
#include "identify/updating/test_problem.hpp"

namespace wems::identify::updating {

struct Selection {
    HypothesisSet set;
    TestPoint point;     ///< with the set's causes, by the identification runs
    TestPoint adjusted;  ///< with adjustments alone
    TestView view;       ///< at `point`
    BlockScales scales;
    std::vector<RankedSet> ranked;  ///< at the last linearisation, all runs together
    Posterior posterior;            ///< of the identification runs
    TestPoint fitted;               ///< of all runs together
    Posterior fitted_posterior;
    std::vector<Decision> decisions;

    /// Probability of a hypothesis over the ranked sets.
    double probabilityOf(int hypothesis) const;
};

/// @param progress may be empty
Selection selectCauses(TestProblem& problem, const std::function<void(const std::string&)>& progress);

/// `clearance 4.z.+ 4.z.-`
std::string describe(const Hypothesis& hypothesis);

/// Evidence of all runs, or of the identification runs alone, at a view.
Evidence makeEvidence(const TestProblem& problem, const TestView& view, const BlockScales& scales,
                      bool with_validation);

}  // namespace wems::identify::updating
