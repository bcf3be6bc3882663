/// @file
/// A round of the search where all numbers but those of the causes are exact: the best few sets are settled, and the
/// evidence at their own estimates decides.
///
/// What is wrong then leaves far more than noise, so that no quadratic about the believed numbers tells what a set will
/// leave in the end.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/updating/standing.hpp"
#include "identify/verdict/diagnosis.hpp"

namespace wems::identify::updating {

class SettledSearch {
public:
    SettledSearch(TestProblem& problem, const Settler& settler, const FreeJudge& judge);

    /// Moves to the best of the candidates, if one is better than the present set.
    /// @param evidence of the view at the present state
    /// @param[out] decision what was done, and the sets that were fitted
    /// @return whether the set changed
    bool takeBest(const Evidence& evidence, const std::vector<RankedSet>& candidates, Standing& standing,
                  Decision& decision);
    /// Whether a larger set is more likely by far, by the quadratic about a state that satisfies the equations.
    bool findsMore(const Evidence& evidence, const std::vector<RankedSet>& candidates, const Standing& standing) const;
    /// Takes back a cause that was still to show that it carries its part.
    void finish(Standing& standing);

private:
    struct Settled {
        SetState state;
        std::vector<double> misfits;  ///< of each block
        std::vector<double> scatter;  ///< standard deviation of a perfect model's
        double log_evidence = 0;
        bool at_rest = false;  ///< no step from there is worth it
    };
    /// Where the search goes on with one cause more that does not take its half alone: two of the same size do so
    /// together.
    struct Anchor {
        Standing standing;
        std::vector<double> misfits;
        TestProblem::Memento memento;
    };

    Settled settle(const Settled& present, const HypothesisSet& set, const Eigen::VectorXd& target);
    TestPoint findStart(const Settled& present, const HypothesisSet& set, const Eigen::VectorXd& target) const;
    /// Of a set that is adopted. @param best of those that were settled so far
    Settled settleFurther(const Settled& begun, const Settled& present, const Settled& best);
    Settled assess(SetState state) const;
    bool isPossibleAnswer(const HypothesisSet& set, const TestPoint& point) const;
    bool mayBeTried(const HypothesisSet& set, const Standing& standing) const;
    bool carriesItsCauses(const Settled& next, const Settled& present) const;

    TestProblem& problem_;
    const Settler& settler_;
    const FreeJudge& judge_;
    std::optional<Anchor> ahead_;
};

}  // namespace wems::identify::updating
