/// @file
/// Which causes the recordings speak for: rounds of linearisation, search by evidence, and moving to the best estimate.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "identify/diagnose/test_problem.hpp"

namespace wems::identify {

/// One candidate of a round with its figures.
struct RankedCause {
    std::string cause;
    std::vector<std::string> where;
    double log_odds = 0;  ///< of the set with it over the set that the round began with
};

/// What a round tried and did.
struct Decision {
    std::string action;                   ///< one sentence
    std::vector<std::string> causes;      ///< those taken after the round, `clearance 4.z.+`
    double log_evidence = 0;              ///< of that set over no cause, at the round's linearisation
    std::vector<double> misfit;           ///< chi-squared per value: mount, bracket, mobile and fixed sensors
    std::vector<RankedCause> candidates;  ///< the best few
};

struct Selection {
    HypothesisSet set;
    TestPoint point;     ///< with the set's causes
    TestPoint adjusted;  ///< with adjustments alone
    TestView view;       ///< at `point`
    BlockScales scales;
    std::vector<RankedSet> ranked;  ///< at the last linearisation, all runs together
    Posterior posterior;            ///< of the identification runs
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

}  // namespace wems::identify
