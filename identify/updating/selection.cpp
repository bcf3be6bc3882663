#include "identify/updating/selection.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "identify/updating/naming.hpp"
#include "identify/updating/number_naming.hpp"

namespace wems::identify::updating {
namespace {

constexpr int kMostRounds = 8;
constexpr std::size_t kBeam = 6;        // sets that a search follows
constexpr std::size_t kMostCauses = 6;  // of one answer: more describe, they do not explain
static_assert(kMostRounds > static_cast<int>(kMostCauses), "a cause each round, and one to see that no more follows");
/// Causes of exact numbers, where there are tolerances: what asks for more is asked of the tolerances. No drawn case
/// had more; on a bench recording the third only took time.
constexpr std::size_t kMostExact = 2;
constexpr std::size_t kShown = 8;  // candidates of a round that its record keeps
constexpr int kMostSettling = 16;  // Gauss–Newton steps
constexpr std::size_t kTried = 8;  // sets of a round that are judged where they lead
constexpr int kMostAttempts = 3;   // of those, sets that are settled and simulated

class Selector {
public:
    Selector(TestProblem& problem, const FreeJudge& judge, const ProgressListener& progress)
        : problem_(problem),
          judge_(judge),
          progress_(progress),
          settler_(problem),
          settled_(problem, settler_, judge_) {}

    Selection run() {
        tell("equations of motion");
        state_.point = problem_.believedPoint();
        state_.view = problem_.view(state_.point, state_.set);
        settler_.settle(state_, kMostSettling, true);
        result_.adjusted = state_.point;
        standing_.judged = judge_(state_.point, state_.set);
        for (int round = 0; round < kMostRounds; ++round)
            if (!step(round)) break;
        settled_.finish(standing_);
        tell("tolerances");
        NamedNumbers named = nameNumbers(problem_, settler_, judge_, kMostCauses, standing_);
        result_.beyond = std::move(named.beyond);
        result_.decisions.insert(result_.decisions.end(), named.decisions.begin(), named.decisions.end());
        dropWorthless();
        result_.fitted = state_.point;
        // What the model leaves beyond the noise is no excuse for its prediction: scales of a perfect model.
        result_.fitted_noise = makeEvidence(problem_, state_.view, {}, true).calcPosterior(state_.set);
        // What is predicted for the validation runs rests on the identification runs alone.
        settler_.settle(state_, kMostRefining, false);
        result_.posterior = calcPosterior();
        result_.noise = makeEvidence(problem_, state_.view, {}, false).calcPosterior(state_.set);
        if (state_.set.empty()) result_.adjusted = state_.point;
        result_.ranked = std::move(standing_.ranked);
        result_.settled = std::move(standing_.settled);
        result_.state = std::move(state_);
        return std::move(result_);
    }

private:
    /// A set, where its estimate leads, and what the equations really say there.
    struct Trial {
        HypothesisSet set;
        TestPoint point;
        double log_evidence = 0;  ///< of the quadratic, less half of what the misfit exceeds the quadratic's by
    };

    /// Of the identification runs. Where exact numbers answer, intervals allow each its tolerance all the same: that
    /// they were exact is not known.
    Posterior calcPosterior() {
        const Numbers assumed = problem_.numbers();
        Posterior posterior = makeEvidence(problem_, state_.view, state_.scales, false).calcPosterior(state_.set);
        if (assumed == Numbers::within_tolerances || state_.set.empty()) return posterior;
        problem_.assume(Numbers::within_tolerances);
        const TestView view = problem_.view(state_.point, state_.set);
        posterior.covariance = makeEvidence(problem_, view, state_.scales, false).calcPosterior(state_.set).covariance;
        problem_.assume(assumed);
        return posterior;
    }

    void tell(const std::string& text) const {
        if (progress_) progress_({text});
    }
    const Hypothesis& at(int hypothesis) const { return problem_.hypotheses()[hypothesis]; }
    Evidence ownEvidence() const { return makeEvidence(problem_, state_.view, state_.scales, true); }

    /// One cause more, one less, or one for another, as the evidence says and the prediction bears out.
    /// @return false when nothing changes any more
    bool step(int round) {
        tell("round " + std::to_string(round + 1));
        if (calcMisfits(sumOf(state_.view, true), problem_.estimateOf(state_.point))[indexOf(Block::bracket)] >=
            kSatisfied)
            problem_.seekMissingMode(state_.point, state_.set);
        state_.view = problem_.view(state_.point);
        const std::vector<double> misfits = calcMisfits(sumOf(state_.view, true), problem_.estimateOf(state_.point));
        state_.scales = settler_.scalesOf(misfits);
        excess_ = excessOf(misfits);
        noise_alone_ = isNoiseAlone(sumOf(state_.view, true), misfits);
        const Evidence evidence = ownEvidence();
        // One cause more at a time: the next one is sought about a state that has this one.
        const std::size_t largest = std::min(kMostCauses, state_.set.size() + 1);
        const std::vector<RankedSet> candidates = evidence.search({state_.set}, kBeam, largest);
        Decision decision = record(evidence);
        if (problem_.numbers() == Numbers::exact) {
            result_.asks_for_more = !problem_.exactlyKnown() && asksForMore(evidence, candidates);
            if (result_.asks_for_more) {
                decision.action = "exact numbers ask for more causes";
                return conclude(decision, false);
            }
            const bool changed = settled_.takeBest(evidence, candidates, standing_, decision.action);
            return conclude(decision, changed);
        }
        if (!isHopeful(evidence, candidates)) {
            decision.action = "no cause takes half of what the equations leave";
            return conclude(decision, false);
        }
        std::vector<Trial> trials = tryBest(evidence, candidates);
        const double present = trials.front().log_evidence;
        std::sort(trials.begin(), trials.end(),
                  [](const Trial& a, const Trial& b) { return a.log_evidence > b.log_evidence; });
        int attempts = 0;
        bool changed = false;
        std::vector<RankedSet> ranked;
        for (Trial& trial : trials) {
            // A set that was judged and found wanting is no alternative.
            bool stands = true;
            if (!changed && trial.set != state_.set && trial.log_evidence > present) {
                stands = ++attempts <= kMostAttempts && accept(trial);
                changed = stands;
            }
            if (stands) ranked.push_back({trial.set, trial.log_evidence});
        }
        standing_.ranked = std::move(ranked);
        decision.action = changed ? "causes changed" : "nothing more to add, take away or exchange";
        return conclude(decision, changed);
    }

    bool conclude(Decision& decision, bool changed) {
        for (const int h : state_.set) decision.causes.push_back(describe(at(h)));
        decision.error = standing_.judged.error;
        result_.decisions.push_back(decision);
        return changed;
    }

    /// Whether what exact numbers leave is rather the tolerances' than that of one cause more.
    bool asksForMore(const Evidence& evidence, const std::vector<RankedSet>& candidates) {
        const bool satisfied = excess_ < kSatisfied - 1;
        if (state_.set.size() >= kMostExact) return !satisfied || settled_.findsMore(evidence, candidates, standing_);
        if (satisfied || state_.set.empty()) return false;
        // One set of equations, and both answers by the quadratic about the same state.
        double most = evidence.calcLogEvidence(state_.set);
        for (const RankedSet& entry : candidates) most = std::max(most, entry.log_evidence);
        problem_.assume(Numbers::within_tolerances);
        const double tolerant = ownEvidence().calcLogEvidence(state_.set);
        problem_.assume(Numbers::exact);
        return tolerant > most + kUnlikely;
    }

    /// Whether some set would leave at most half of what exceeds the noise, by the quadratic, or that is little anyway.
    bool isHopeful(const Evidence& evidence, const std::vector<RankedSet>& candidates) const {
        const Information all = sumOf(state_.view, true);
        if (excess_ < kSatisfied - 1) return true;
        int seen = 0;
        for (const RankedSet& entry : candidates) {
            if (++seen > static_cast<int>(kTried)) break;
            if (excessOf(calcMisfits(all, evidence.solve(entry.members).mean)) < 0.5 * excess_) return true;
        }
        return false;
    }

    /// Beyond the noise, of the block that leaves most.
    static double excessOf(const std::vector<double>& misfits) {
        return *std::max_element(misfits.begin(), misfits.end()) - 1;
    }

    /// Whether equations that leave more than noise leave half of what exceeds it with a set.
    bool isNeeded(const SetState& next) const {
        return !noise_alone_ &&
               excessOf(calcMisfits(sumOf(next.view, true), problem_.estimateOf(next.point))) < 0.5 * excess_;
    }

    /// Settles a set and takes it if what it adds lies beyond its tolerance and serves the prediction or the equations.
    bool accept(const Trial& trial) {
        const TestProblem::Memento before = problem_.adopt(trial.set);
        SetState next;
        next.set = trial.set;
        // Rows count from new believed values and columns are others now.
        next.point = problem_.pointAt(problem_.estimateOf(trial.point), next.set);
        next.view = problem_.view(next.point, next.set);
        settler_.settle(next, kMostRefining, true);
        const FreeError judged = judge_(next.point, next.set);
        if (!isWorthwhile(next, judged)) {
            problem_.restore(before);
            return false;
        }
        if (isNeeded(next))
            for (const int h : next.set)
                if (!std::binary_search(state_.set.begin(), state_.set.end(), h)) needed_.push_back(h);
        state_ = std::move(next);
        standing_.judged = judged;
        return true;
    }

    bool isWorthwhile(const SetState& next, const FreeError& judged) const {
        if (!isPossible(problem_, next.set, problem_.estimateOf(next.point))) return false;
        bool must_improve = false;
        const bool needed = isNeeded(next);
        for (const int h : next.set) {
            if (std::binary_search(state_.set.begin(), state_.set.end(), h)) continue;
            if (!isBeyondTolerance(problem_, at(h), next.point)) return false;
            must_improve = must_improve || (!needed && !isSensorFault(at(h)));
        }
        return must_improve ? isImproved(standing_.judged, judged)
                            : judged.error <= (1 + kWorth) * standing_.judged.error;
    }

    /// Whether a cause stays, by the prediction without it. Where the equations leave more than noise, something else
    /// is at work in them, and what they say of a part below the noise is not believed.
    bool isWorthKeeping(const FreeError& without) const {
        const Information all = sumOf(state_.view, true);
        const bool doubtful = !isNoiseAlone(all, calcMisfits(all, problem_.estimateOf(state_.point)));
        return !isWorthless(standing_.judged, without) && !(doubtful && isBelowNoise(standing_.judged, without));
    }

    /// Causes of earlier rounds without which the prediction is as good by now.
    void dropWorthless() {
        for (bool changed = true; changed;) {
            changed = false;
            const Evidence evidence = ownEvidence();
            for (const int h : state_.set) {
                if (isSensorFault(at(h)) || result_.beyond.count(h) > 0 ||
                    std::find(needed_.begin(), needed_.end(), h) != needed_.end() ||
                    isWorthKeeping(judge_(holdBack(problem_, state_, h, evidence), state_.set)))
                    continue;
                state_.set.erase(std::find(state_.set.begin(), state_.set.end(), h));
                problem_.adopt(state_.set);
                state_.point = problem_.reduce(state_.point, state_.set);
                state_.view = problem_.view(state_.point, state_.set);
                settler_.settle(state_, kMostRefining, true);
                standing_.judged = judge_(state_.point, state_.set);
                changed = true;
                break;
            }
        }
    }

    /// The present set, then the best few by the quadratic, each judged where its estimate lies: laws and sensors are
    /// not of first order.
    std::vector<Trial> tryBest(const Evidence& evidence, const std::vector<RankedSet>& ranked) {
        const Eigen::VectorXd present = problem_.estimateOf(state_.point);
        std::vector<Trial> trials{{state_.set, state_.point, evidence.calcLogEvidence(state_.set)}};
        std::vector<std::string> known{signatureOf(problem_, state_.set)};
        const SetSolution settled = evidence.solve(state_.set);
        // The present point is near the quadratic's estimate of its set: a trial differs from it as the estimates do.
        const Eigen::VectorXd shift = present - settled.mean;
        for (const RankedSet& entry : ranked) {
            if (trials.size() > kTried) break;
            const std::string signature = signatureOf(problem_, entry.members);
            if (std::find(known.begin(), known.end(), signature) != known.end()) continue;
            const SetSolution solution = evidence.solve(entry.members);
            const Eigen::VectorXd target = solution.mean + shift;
            if (!isWanted(entry.members, target)) continue;
            known.push_back(signature);
            const double best = std::max_element(trials.begin(), trials.end(), [](const Trial& a, const Trial& b) {
                                    return a.log_evidence < b.log_evidence;
                                })->log_evidence;
            Trial trial{entry.members, problem_.pointAt(target, entry.members), entry.log_evidence};
            const double excess = settler_.calcExcess(state_.view, trial.point, target, state_.scales, true);
            trial.log_evidence -= 0.5 * std::max(0.0, excess);
            if (entry.log_evidence > best && trial.log_evidence < best) {
                const double here = evidence.calcChange(present) + settler_.calcPriorSquare(present, state_.set);
                const double gained = here - refine(trial, evidence);
                trial.log_evidence = std::max(
                    trial.log_evidence, std::min(entry.log_evidence, trials.front().log_evidence + solution.occam -
                                                                         settled.occam + 0.5 * gained));
            }
            trials.push_back(std::move(trial));
            if (entry.log_evidence < trials.front().log_evidence - kUnlikely) break;
        }
        return trials;
    }

    /// Mechanisms with the sign that they can have, numbers beyond their tolerance.
    bool isWanted(const HypothesisSet& set, const Eigen::VectorXd& estimate) const {
        if (!isPossible(problem_, set, estimate)) return false;
        const TestPoint point = problem_.pointAt(estimate, set);
        return std::all_of(set.begin(), set.end(), [&](int h) { return isBeyondTolerance(problem_, at(h), point); });
    }

    /// Gauss–Newton steps of a trial that is not of first order.
    /// @return −2 log of likelihood and prior where they lead, as the present view has it
    double refine(Trial& trial, const Evidence& evidence) {
        const TestProblem::Memento before = problem_.adopt(trial.set);
        TestPoint point = settler_.refine(trial.point, trial.set, state_.scales, kMostRefining);
        const double prior = settler_.calcPriorSquare(problem_.estimateOf(point), trial.set);
        problem_.restore(before);
        const Eigen::VectorXd estimate = problem_.estimateOf(point);
        trial.point = std::move(point);
        return evidence.calcChange(estimate) + prior +
               settler_.calcExcess(state_.view, trial.point, estimate, state_.scales, true);
    }

    /// What the round began with, and its candidates.
    Decision record(const Evidence& evidence) const {
        Decision decision;
        decision.log_evidence = evidence.calcLogEvidence(state_.set) - evidence.calcLogEvidence({});
        decision.misfit = calcMisfits(sumOf(state_.view, true), problem_.estimateOf(state_.point));
        const double base = evidence.calcLogEvidence(state_.set);
        const auto extended = evidence.calcExtensions(state_.set);
        std::vector<std::size_t> order(extended.size());
        for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
        std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return extended[a] > extended[b]; });
        for (std::size_t i = 0; i < std::min(kShown, order.size()); ++i) {
            const auto& hypothesis = problem_.hypotheses()[order[i]];
            if (std::isfinite(extended[order[i]]))
                decision.candidates.push_back({hypothesis.cause, hypothesis.where, extended[order[i]] - base});
        }
        return decision;
    }

    TestProblem& problem_;
    const FreeJudge& judge_;
    const ProgressListener& progress_;
    Settler settler_;
    SettledSearch settled_;
    Standing standing_;
    SetState& state_ = standing_.state;
    double excess_ = 0;         // of the equations at the present state, beyond the noise
    bool noise_alone_ = false;  // whether it is none
    std::vector<int> needed_;   // causes without which the equations leave twice as much
    Selection result_;
};

}  // namespace

double Selection::probabilityOf(int hypothesis) const {
    const auto number = beyond.find(hypothesis);
    if (number != beyond.end()) return number->second;
    double with = 0, all = 0;
    for (const RankedSet& entry : ranked) {
        const double weight = std::exp(entry.log_evidence - ranked.front().log_evidence);
        all += weight;
        if (std::binary_search(entry.members.begin(), entry.members.end(), hypothesis)) with += weight;
    }
    return all > 0 ? with / all : 0;
}

Selection selectCauses(TestProblem& problem, const FreeJudge& judge, const ProgressListener& progress) {
    return Selector(problem, judge, progress).run();
}

}  // namespace wems::identify::updating
