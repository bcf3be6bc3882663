#include "identify/updating/log_odds.hpp"

#include <algorithm>
#include <iterator>

#include "identify/updating/naming.hpp"

namespace wems::identify::updating {
namespace {

/// What all runs say about a state, with the columns of the members of another set.
Information viewWith(TestProblem& problem, const SetState& state, const HypothesisSet& other) {
    HypothesisSet both;
    std::set_union(state.set.begin(), state.set.end(), other.begin(), other.end(), std::back_inserter(both));
    if (both == state.set) return sumOf(state.view, true);
    const TestProblem::Memento before = problem.adopt(both);
    Information all = sumOf(problem.view(state.point, both), true);
    problem.restore(before);
    return all;
}

}  // namespace

double calcKnownPart(const Information& all, const BlockScales& scales, const Eigen::VectorXd& reach,
                     const Eigen::VectorXd& step) {
    Information steady = all;
    for (BlockInformation& block : steady) block.scatter.resize(0, 0);
    const double known = step.dot(combine(all, scales, reach).A * step);
    const double whole = step.dot(combine(steady, scales, reach).A * step);
    return whole > 0 ? std::clamp(known / whole, 0.0, 1.0) : 1.0;
}

double calcLogOdds(TestProblem& problem, const Settler& settler, const SetState& set, const SetState& other) {
    struct Weight {
        double cost, log_evidence;
    };
    const auto weigh = [&](const SetState& state) -> Weight {
        const TestProblem::Memento before = problem.adopt(state.set);
        const Information all = sumOf(state.view, true);
        const Weight weight{settler.calcCost(all, calcMisfits(all, problem.estimateOf(state.point))),
                            settler.calcLogEvidence(state)};
        problem.restore(before);
        return weight;
    };
    const Weight own = weigh(set), rival = weigh(other);
    const double odds = own.log_evidence - rival.log_evidence, gained = rival.cost - own.cost;
    const SetState& better = gained > 0 ? set : other;
    if (gained == 0 || !hasBursts(sumOf(better.view, true))) return odds;
    const Eigen::VectorXd step = problem.estimateOf(set.point) - problem.estimateOf(other.point);
    const Information all = viewWith(problem, better, gained > 0 ? other.set : set.set);
    return odds - 0.5 * (1 - calcKnownPart(all, better.scales, problem.reaches(), step)) * gained;
}

}  // namespace wems::identify::updating
