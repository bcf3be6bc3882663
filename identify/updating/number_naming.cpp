#include "identify/updating/number_naming.hpp"

#include <algorithm>
#include <utility>

#include "identify/updating/naming.hpp"

namespace wems::identify::updating {
namespace {

/// Probability of lying beyond that satisfied equations must give a number which unsatisfied ones pull at: of the
/// numbers that they hardly know, one in twenty comes out so by chance.
constexpr double kSure = 0.95;

class NumberNaming {
public:
    NumberNaming(const TestProblem& problem, const Settler& settler, const FreeJudge& judge, Standing& standing)
        : problem_(problem), settler_(settler), judge_(judge), standing_(standing), state_(standing.state) {}

    NamedNumbers run(std::size_t most) {
        while (state_.set.size() < most) {
            const int best = findLikeliest();
            if (best < 0) break;
            if (!name(best)) refused_.push_back(best);
        }
        return std::move(result_);
    }

private:
    const Hypothesis& at(int hypothesis) const { return problem_.hypotheses()[hypothesis]; }

    /// The number that the evidence would rather have free than any other; −1 if there is none.
    int findLikeliest() const {
        const Evidence evidence = makeEvidence(problem_, state_.view, state_.set, state_.scales, true);
        const Posterior posterior = evidence.calcPosterior(state_.set);
        const std::vector<double> extended = evidence.calcExtensions(state_.set);
        double most = evidence.calcLogEvidence(state_.set);
        int best = -1;
        for (int h = 0; h < static_cast<int>(problem_.hypotheses().size()); ++h) {
            const double own = extended[h];
            if (!(own > most) || !isOwnNumbers(at(h)) ||
                std::find(refused_.begin(), refused_.end(), h) != refused_.end() ||
                calcBeyondProbability(problem_, at(h), state_.point, posterior) < 0.5)
                continue;
            most = own;
            best = h;
        }
        return best;
    }

    bool name(int hypothesis) {
        SetState next = state_;
        next.set.insert(std::lower_bound(next.set.begin(), next.set.end(), hypothesis), hypothesis);
        settler_.settle(next, kMostRefining, true);
        const FreeError judged = judge_(next.point, next.set);
        const Evidence evidence = makeEvidence(problem_, next.view, next.set, next.scales, true);
        // No cause explains by a prediction that is worse with it, unless both are as good as asked for.
        const FreeError& before = standing_.judged;
        if (isSensorFault(at(hypothesis)) ? judged.error > (1 + kWorth) * before.error : isSpoilt(before, judged))
            return false;
        if (!isSensorFault(at(hypothesis)) && !isNeededBeyond(next, judged, hypothesis, evidence)) return false;
        const Posterior posterior = evidence.calcPosterior(next.set);
        const double probability = calcBeyondProbability(problem_, at(hypothesis), next.point, posterior);
        if (probability < 0.5 || !isBorneOut(next, hypothesis, evidence)) return false;
        state_ = std::move(next);
        standing_.judged = judged;
        result_.beyond[hypothesis] = probability;
        Decision decision;
        decision.action = "beyond its tolerance: " + describe(at(hypothesis));
        decision.causes = describe(problem_, state_.set);
        decision.misfit = calcMisfits(sumOf(state_.view, true), problem_.estimateOf(state_.point));
        decision.error = standing_.judged.error;
        result_.decisions.push_back(decision);
        return true;
    }

    /// A number moved before it had a name: what the prediction makes of it shows where it is brought back to its
    /// tolerance. If all others could then make up for it, the equations must speak for it by far.
    bool isNeededBeyond(const SetState& next, const FreeError& judged, int hypothesis, const Evidence& evidence) const {
        if (isWorthless(judged, judge_(bringBack(problem_, next, at(hypothesis)), next.set))) return false;
        return evidence.calcLogEvidence(next.set) - evidence.calcLogEvidence(state_.set) > kUnlikely ||
               !isWorthless(judged, judge_(holdBack(problem_, next, hypothesis, evidence), next.set));
    }

    /// Equations that leave much beyond the noise pull at every number that could make up for a little of it. There a
    /// number is a cause only if it takes half of what they leave, as any other cause; or if those that are satisfied
    /// put it beyond its tolerance by themselves.
    bool isBorneOut(const SetState& next, int hypothesis, const Evidence& evidence) const {
        const Information all = sumOf(next.view, true);
        const Eigen::VectorXd with = problem_.estimateOf(next.point);
        const std::vector<double> misfits = calcMisfits(all, with);
        if (isSatisfied(misfits)) return true;
        if (takesHalf(all, with, problem_.estimateOf(holdBack(problem_, next, hypothesis, evidence)))) return true;
        // From what is believed, where nothing has been pulled yet.
        Information satisfied = sumOf(problem_.view(problem_.believedPoint(), next.set), true);
        for (std::size_t k = 0; k < kBlocks; ++k)
            if (misfits[k] >= kSatisfied) satisfied[k] = {};
        if (std::all_of(satisfied.begin(), satisfied.end(), [](const auto& own) { return own.empty(); })) return false;
        const Posterior alone =
            SetEvidence(problem_, satisfied, settler_.scalesOf(misfits), next.set, with).calcPosterior();
        return calcBeyondProbability(problem_, at(hypothesis), problem_.pointAt(alone.mean, next.set), alone) >= kSure;
    }

    /// Every direction a number of the table with a tolerance, from the present state.
    bool isOwnNumbers(const Hypothesis& hypothesis) const {
        return hypothesis.start.empty() && hypothesis.moves.empty() &&
               std::all_of(hypothesis.directions.begin(), hypothesis.directions.end(), [&](const Direction& own) {
                   return own.size() == 1 && static_cast<std::size_t>(own.front().first) < problem_.table().size() &&
                          problem_.table()[own.front().first].deviation > 0;
               });
    }

    const TestProblem& problem_;
    const Settler& settler_;
    const FreeJudge& judge_;
    Standing& standing_;
    SetState& state_;
    std::vector<int> refused_;
    NamedNumbers result_;
};

}  // namespace

NamedNumbers nameNumbers(const TestProblem& problem, const Settler& settler, const FreeJudge& judge, std::size_t most,
                         Standing& standing) {
    return NumberNaming(problem, settler, judge, standing).run(most);
}

}  // namespace wems::identify::updating
