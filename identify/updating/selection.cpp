#include "identify/updating/selection.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "identify/updating/naming.hpp"
#include "identify/updating/number_naming.hpp"
#include "identify/updating/other_form.hpp"
#include "identify/updating/settled_search.hpp"
#include "identify/updating/tolerant_search.hpp"
#include "models/common/format_number.hpp"

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

class Selector {
public:
    Selector(TestProblem& problem, const FreeJudge& judge, const BandJudge& band, const ProgressListener& progress)
        : problem_(problem),
          judge_(judge),
          progress_(progress),
          settler_(problem),
          settled_(problem, settler_, judge_),
          tolerant_(problem, settler_, judge_, band, progress_) {}

    Selection run() {
        tell("equations of motion");
        state_.point = problem_.believedPoint();
        state_.view = problem_.view(state_.point, state_.set);
        settler_.settle(state_, kMostSettling, true);
        result_.adjusted = state_.point;
        standing_.judged = judge_(state_.point, state_.set);
        int round = 0;
        do {
            while (round < kMostRounds && step(round)) {
                ++round;
                comeToRest();
            }
            settled_.finish(standing_);
        } while (nameBeyond() && takeFewer());
        comeToRest();
        dropWorthless();
        dropOtherForm();
        result_.fitted = state_.point;
        // What the model leaves beyond the noise is no excuse for its prediction: scales of a perfect model.
        result_.fitted_noise = makeEvidence(problem_, state_.view, state_.set, {}, true).calcPosterior(state_.set);
        // What is predicted for the validation runs rests on the identification runs alone.
        settler_.settle(state_, kMostRefining, false);
        result_.posterior = calcPosterior();
        result_.noise = makeEvidence(problem_, state_.view, state_.set, {}, false).calcPosterior(state_.set);
        if (state_.set.empty()) result_.adjusted = state_.point;
        result_.ranked = std::move(standing_.ranked);
        result_.settled = std::move(standing_.settled);
        result_.state = std::move(state_);
        return std::move(result_);
    }

private:
    /// Of the identification runs. Where exact numbers answer, intervals allow each its tolerance all the same: that
    /// they were exact is not known.
    Posterior calcPosterior() {
        const Numbers assumed = problem_.numbers();
        Posterior posterior =
            makeEvidence(problem_, state_.view, state_.set, state_.scales, false).calcPosterior(state_.set);
        if (assumed == Numbers::within_tolerances || state_.set.empty()) return posterior;
        problem_.assume(Numbers::within_tolerances);
        const TestView view = problem_.view(state_.point, state_.set);
        posterior.covariance =
            makeEvidence(problem_, view, state_.set, state_.scales, false).calcPosterior(state_.set).covariance;
        problem_.assume(assumed);
        return posterior;
    }

    /// A set is taken after the few steps that tell it from others. What follows compares with it, and the answer gives
    /// its numbers.
    void comeToRest() {
        if (problem_.numbers() == Numbers::exact) return;  // settled before they are taken
        settler_.settle(state_, kMostSettling, true);
        standing_.judged = judge_(state_.point, state_.set);
    }

    void tell(const std::string& text) const {
        if (progress_) progress_({text});
    }
    const Hypothesis& at(int hypothesis) const { return problem_.hypotheses()[hypothesis]; }
    Evidence ownEvidence() const { return makeEvidence(problem_, state_.view, state_.set, state_.scales, true); }

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
        const Evidence evidence = ownEvidence();
        // One cause more at a time: the next one is sought about a state that has this one.
        const std::size_t largest = std::min(kMostCauses, state_.set.size() + 1);
        const std::vector<RankedSet> candidates = evidence.search({state_.set}, kBeam, largest);
        Decision decision = record(evidence);
        const bool exact = problem_.numbers() == Numbers::exact;
        result_.asks_for_more =
            exact && !problem_.exactlyKnown() && asksForMore(evidence, candidates, isSatisfied(misfits));
        if (result_.asks_for_more) {
            decision.action = "exact numbers ask for more causes";
            return conclude(decision, false);
        }
        const bool changed = exact ? settled_.takeBest(evidence, candidates, standing_, decision)
                                   : tolerant_.takeBest(evidence, candidates, standing_, decision);
        return conclude(decision, changed);
    }

    bool conclude(Decision& decision, bool changed) {
        decision.causes = describe(problem_, state_.set);
        decision.error = standing_.judged.error;
        result_.decisions.push_back(decision);
        return changed;
    }

    /// Whether what exact numbers leave is rather the tolerances' than that of one cause more.
    bool asksForMore(const Evidence& evidence, const std::vector<RankedSet>& candidates, bool satisfied) {
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

    /// Whether a cause stays, by the prediction without it. Where the equations leave more than noise, something else
    /// is at work in them, and what they say of a part below the noise is not believed.
    bool isWorthKeeping(const FreeError& without) const {
        const Information all = sumOf(state_.view, true);
        const bool doubtful = !isNoiseAlone(all, calcMisfits(all, problem_.estimateOf(state_.point)));
        return !isWorthless(standing_.judged, without) && !(doubtful && isBelowNoise(standing_.judged, without));
    }

    /// Numbers that adjustments carried beyond their tolerances become causes.
    /// @return whether there were any
    bool nameBeyond() {
        tell("tolerances");
        const NamedNumbers named = nameNumbers(problem_, settler_, judge_, kMostCauses, standing_);
        for (const auto& [number, probability] : named.beyond) result_.beyond[number] = probability;
        result_.decisions.insert(result_.decisions.end(), named.decisions.begin(), named.decisions.end());
        return !named.beyond.empty();
    }

    /// A mechanism that was taken while such a number was held to its tolerance may have stood for it.
    bool takeFewer() {
        if (problem_.numbers() == Numbers::exact || state_.set.size() < 2) return false;
        Decision decision;
        decision.misfit = calcMisfits(sumOf(state_.view, true), problem_.estimateOf(state_.point));
        return conclude(decision, tolerant_.takeFewer(ownEvidence(), standing_, decision));
    }

    /// Causes of earlier rounds without which the prediction is as good by now, and numbers that others have put back
    /// within their tolerances: those are none.
    void dropWorthless() {
        const std::vector<int>& needed = tolerant_.needed();
        for (bool changed = true; changed;) {
            changed = false;
            const Evidence evidence = ownEvidence();
            for (const int h : state_.set) {
                const bool is_none = !isBeyondTolerance(problem_, at(h), state_.point);
                if (!is_none && (isSensorFault(at(h)) || result_.beyond.count(h) > 0 ||
                                 std::find(needed.begin(), needed.end(), h) != needed.end() ||
                                 isWorthKeeping(judge_(holdBack(problem_, state_, h, evidence), state_.set))))
                    continue;
                leaveOut(h);
                changed = true;
                break;
            }
        }
    }

    /// The cause of an elastic law for which another form speaks most is taken back. Of one alone: what it leaves then
    /// would speak against causes of neighbouring axes, too.
    void dropOtherForm() {
        std::optional<OtherForm> best;
        int taken_back = -1;
        for (const int h : state_.set) {
            std::optional<OtherForm> other = findOtherForm(problem_, settler_, state_, h);
            if (!other || other->log_odds <= (best ? best->log_odds : 0)) continue;
            best = std::move(other);
            taken_back = h;
        }
        if (!best) return;
        Decision decision;
        decision.action = "the force of the displacement has another form than " + describe(at(taken_back)) +
                          ", log odds " + formatNumber(best->log_odds, 3);
        decision.misfit = calcMisfits(sumOf(state_.view, true), problem_.estimateOf(state_.point));
        result_.elastic_laws = std::move(best->laws);
        leaveOut(taken_back);
        conclude(decision, true);
    }

    /// The state without a cause.
    void leaveOut(int hypothesis) {
        state_.set.erase(std::find(state_.set.begin(), state_.set.end(), hypothesis));
        problem_.adopt(state_.set);
        state_.point = problem_.reduce(state_.point, state_.set);
        state_.view = problem_.view(state_.point, state_.set);
        settler_.settle(state_, kMostRefining, true);
        standing_.judged = judge_(state_.point, state_.set);
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
    TolerantSearch tolerant_;
    Standing standing_;
    SetState& state_ = standing_.state;
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

Selection selectCauses(TestProblem& problem, const FreeJudge& judge, const BandJudge& band,
                       const ProgressListener& progress) {
    return Selector(problem, judge, band, progress).run();
}

}  // namespace wems::identify::updating
