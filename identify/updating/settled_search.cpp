#include "identify/updating/settled_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "identify/updating/log_odds.hpp"
#include "identify/updating/naming.hpp"
#include "identify/updating/rivals.hpp"

namespace wems::identify::updating {
namespace {

// For time: not varied but for eight sets settled to their end, which took about twice as long.
constexpr std::size_t kSettledSets = 8;  // sets of a round that are settled, where numbers are exact by statement …
constexpr int kFirstSteps = 4;           // … so far, all of them …
constexpr std::size_t kFurtherSets = 3;  // … and so many to their end; no more where what is left may be tolerances'
constexpr int kSettlingSteps = 16;       // of Gauss and Newton

}  // namespace

SettledSearch::SettledSearch(TestProblem& problem, const Settler& settler, const FreeJudge& judge)
    : problem_(problem), settler_(settler), judge_(judge) {}

bool SettledSearch::takeBest(const Evidence& evidence, const std::vector<RankedSet>& candidates, Standing& standing,
                             Decision& decision) {
    const Settled present = assess(standing.state);
    const bool satisfied = isSatisfied(present.misfits);
    const double least = evidence.calcLogEvidence(present.state.set) - kUnlikely;
    std::vector<std::string> known{signatureOf(problem_, present.state.set)};
    std::vector<Settled> tried;
    const std::size_t most = problem_.exactlyKnown() ? kSettledSets : kFurtherSets;
    const TestProblem::Memento before = problem_.remember();
    for (const RankedSet& entry : candidates) {
        if (known.size() > most) break;
        const std::string signature = signatureOf(problem_, entry.members);
        if (std::find(known.begin(), known.end(), signature) != known.end() || !mayBeTried(entry.members, standing))
            continue;
        const Eigen::VectorXd target = evidence.solve(entry.members).mean;
        // About a state that satisfies the equations the quadratic says what they say.
        if (satisfied &&
            (entry.log_evidence < least || !isPossibleAnswer(entry.members, problem_.pointAt(target, entry.members))))
            continue;
        known.push_back(signature);
        tried.push_back(settle(present, entry.members, target));
        problem_.restore(before);
    }
    std::sort(tried.begin(), tried.end(),
              [](const Settled& a, const Settled& b) { return a.log_evidence > b.log_evidence; });
    Settled best = present;
    std::size_t record = 0;  // of the best
    std::vector<RankedSet> ranked{{best.state.set, best.log_evidence}};
    for (std::size_t i = 0; i < tried.size(); ++i) {
        problem_.adopt(tried[i].state.set);
        if (i < kFurtherSets) tried[i] = settleFurther(tried[i], present, best);
        tried[i].log_evidence = best.log_evidence + calcLogOdds(problem_, settler_, tried[i].state, best.state);
        const SetState& state = tried[i].state;
        const bool possible = isPossibleAnswer(state.set, state.point);
        const bool imaginable = possible || isPossible(problem_, state.set, problem_.estimateOf(state.point));
        problem_.restore(before);
        decision.fitted.push_back({describe(problem_, state.set),
                                   tried[i].log_evidence - present.log_evidence,
                                   {},
                                   possible ? kLessLikely : (imaginable ? kWithin : kImpossible)});
        if (!possible) continue;
        ranked.push_back({tried[i].state.set, tried[i].log_evidence});
        standing.settled.insert_or_assign(tried[i].state.set, tried[i].state.point);
        if (!(tried[i].log_evidence > best.log_evidence)) continue;
        best = tried[i];
        record = decision.fitted.size() - 1;
    }
    keepRivals(standing, ranked);
    carryRivals(standing, best.state.set, ranked);
    std::sort(ranked.begin(), ranked.end(),
              [](const RankedSet& a, const RankedSet& b) { return a.log_evidence > b.log_evidence; });
    const bool better = best.state.set != present.state.set, carries = better && carriesItsCauses(best, present);
    if (better && !carries) decision.fitted[record].outcome = "takes no half of what the equations leave";
    if (ahead_ && !carries) {
        finish(standing);
        decision.action = "the last cause is taken back: the equations leave no half of what they left";
        return false;
    }
    // One more that is to show itself later is worth its time only where nothing else follows this search.
    if (!better || (!carries && !problem_.exactlyKnown())) {
        standing.ranked = std::move(ranked);
        decision.action = "nothing more to add, take away or exchange";
        return false;
    }
    problem_.adopt(best.state.set);
    const FreeError judged = judge_(best.state.point, best.state.set);
    decision.fitted[record].error = judged.error;
    if (!isWorthExplaining(standing.judged) && judged.error > (1 + kWorth) * standing.judged.error) {
        problem_.restore(before);
        decision.fitted[record].outcome = kSpoils;
        standing.ranked = {{present.state.set, present.log_evidence}};
        decision.action = "a fault of sensors is not taken: the prediction is worse with it";
        return false;
    }
    if (carries)
        ahead_.reset();
    else
        ahead_ = Anchor{standing, present.misfits, before};
    standing.judged = judged;
    standing.state = std::move(best.state);
    standing.ranked = std::move(ranked);
    decision.fitted[record].outcome = kTaken;
    decision.action = "causes changed";
    return true;
}

bool SettledSearch::findsMore(const Evidence& evidence, const std::vector<RankedSet>& candidates,
                              const Standing& standing) const {
    const HypothesisSet& present = standing.state.set;
    const double least = evidence.calcLogEvidence(present) + kUnlikely;
    return std::any_of(candidates.begin(), candidates.end(), [&](const RankedSet& entry) {
        return entry.members.size() > present.size() && entry.log_evidence > least &&
               isPossibleAnswer(entry.members, problem_.pointAt(evidence.solve(entry.members).mean, entry.members));
    });
}

void SettledSearch::finish(Standing& standing) {
    if (!ahead_) return;
    problem_.restore(ahead_->memento);
    standing = std::move(ahead_->standing);
    ahead_.reset();
}

/// The present point, or where the quadratic leads if that leaves less.
TestPoint SettledSearch::findStart(const Settled& present, const HypothesisSet& set,
                                   const Eigen::VectorXd& target) const {
    TestPoint led = problem_.pointAt(target, set), stay = problem_.reduce(present.state.point, set);
    const double here = stay.values == present.state.point.values
                            ? settler_.calcCost(sumOf(present.state.view, true), present.misfits)
                            : settler_.calcCostAt(stay);
    return settler_.calcCostAt(led) < here ? led : stay;
}

/// Adopts a set and settles it: from the best start, and from as far as a probe was. A stop that is not reached has no
/// slope, so that only the latter can find it nearer.
SettledSearch::Settled SettledSearch::settle(const Settled& present, const HypothesisSet& set,
                                             const Eigen::VectorXd& target) {
    std::vector<TestPoint> starts{findStart(present, set, target)};
    if (const auto far = problem_.goToProbes(present.state.point, set)) starts.push_back(*far);
    problem_.adopt(set);
    std::optional<Settled> best;
    for (const TestPoint& start : starts) {
        SetState state;
        state.set = set;
        state.point = problem_.reduce(start, set);
        state.view = problem_.view(state.point, set);
        const bool at_rest = settler_.settle(state, kFirstSteps, true);
        Settled own = assess(std::move(state));
        own.at_rest = at_rest;
        if (!best || own.log_evidence > best->log_evidence) best = std::move(own);
    }
    return std::move(*best);
}

SettledSearch::Settled SettledSearch::settleFurther(const Settled& begun, const Settled& present, const Settled& best) {
    SetState state = begun.state;
    bool at_rest = begun.at_rest;
    // Sets share numbers: where another one led may be nearer.
    TestPoint shared = problem_.reduce(best.state.point, state.set);
    if (best.state.set != present.state.set &&
        settler_.calcCostAt(shared) < settler_.calcCost(sumOf(state.view, true), begun.misfits)) {
        state.point = std::move(shared);
        state.view = problem_.view(state.point, state.set);
        at_rest = false;
    }
    if (!at_rest) settler_.settle(state, kSettlingSteps - kFirstSteps, true);
    Settled own = assess(std::move(state));
    constexpr std::size_t mount = indexOf(Block::mount), bracket = indexOf(Block::bracket);
    if (own.misfits[bracket] <= present.misfits[bracket] || own.misfits[mount] >= present.misfits[mount]) return own;
    // The bracket answers the mobile part's whole motion through its resonances, so that its misfit may rise on the way
    // to the truth: for a centre of gravity off by 0.14 m it doubles half way. The mount's equation knows the way.
    BlockScales scales = own.state.scales;
    scales[bracket].scale = std::numeric_limits<double>::infinity();
    SetState led;
    led.set = own.state.set;
    led.point = settler_.refine(own.state.point, led.set, scales, kSettlingSteps);
    led.view = problem_.view(led.point, led.set);
    settler_.settle(led, kSettlingSteps, true);
    Settled other = assess(std::move(led));
    return other.log_evidence > own.log_evidence ? other : own;
}

SettledSearch::Settled SettledSearch::assess(SetState state) const {
    const Information all = sumOf(state.view, true);
    const Eigen::VectorXd estimate = problem_.estimateOf(state.point);
    const double log_evidence = settler_.calcLogEvidence(state);
    return {std::move(state), calcMisfits(all, estimate), calcScatter(all), log_evidence, false};
}

bool SettledSearch::isPossibleAnswer(const HypothesisSet& set, const TestPoint& point) const {
    return isPossible(problem_, set, problem_.estimateOf(point)) && std::all_of(set.begin(), set.end(), [&](int h) {
               return isBeyondTolerance(problem_, problem_.hypotheses()[h], point);
           });
}

/// What the simulation does well enough asks for no further mechanism (contract: `nothing_missing` when no cause is
/// needed), only for faults of sensors, which simulations need not show.
bool SettledSearch::mayBeTried(const HypothesisSet& set, const Standing& standing) const {
    return isWorthExplaining(standing.judged) || std::all_of(set.begin(), set.end(), [&](int h) {
               return isSensorFault(problem_.hypotheses()[h]) ||
                      std::binary_search(standing.state.set.begin(), standing.state.set.end(), h);
           });
}

/// Whether some equations leave half of what they left for each cause more: what no cause explains asks each for a
/// little, as does what contact folds into the samples.
bool SettledSearch::carriesItsCauses(const Settled& next, const Settled& present) const {
    const std::size_t causes = ahead_ ? ahead_->standing.state.set.size() : present.state.set.size();
    if (next.state.set.size() <= causes) return true;
    const double part = std::pow(0.5, static_cast<double>(next.state.set.size() - causes));
    const std::vector<double>& before = ahead_ ? ahead_->misfits : present.misfits;
    for (std::size_t k = 0; k < kBlocks; ++k)
        if (before[k] - 1 > kBeyondNoise * next.scatter[k] && next.misfits[k] - 1 <= part * (before[k] - 1))
            return true;
    return false;
}

}  // namespace wems::identify::updating
