#include "identify/updating/tolerant_search.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "identify/updating/fresh_start.hpp"
#include "identify/updating/log_odds.hpp"
#include "identify/updating/naming.hpp"
#include "identify/updating/rivals.hpp"

namespace wems::identify::updating {
namespace {

constexpr int kMostAttempts = 3;  // sets of a round that are settled, for time
// Steps of what begins far away, for time: as many as sets of causes have. Six drawn starts came to rest after 5 or 6.
constexpr int kMostAfresh = 16;

void sortByEvidence(std::vector<RankedSet>& ranked) {
    std::sort(ranked.begin(), ranked.end(),
              [](const RankedSet& a, const RankedSet& b) { return a.log_evidence > b.log_evidence; });
}

}  // namespace

TolerantSearch::TolerantSearch(TestProblem& problem, const Settler& settler, const FreeJudge& judge,
                               const BandJudge& band, const ProgressListener& progress)
    : problem_(problem), settler_(settler), judge_(judge), band_(band), progress_(progress) {}

bool TolerantSearch::takeBest(const Evidence& evidence, const std::vector<RankedSet>& candidates, Standing& standing,
                              Decision& decision) {
    if (takeFewer(evidence, standing, decision)) return true;
    const SetState& present = standing.state;
    if (!isHopeful(evidence, candidates, present)) {
        decision.action = "no cause takes half of what the equations leave";
        decision.fitted = std::move(fitted_);
        return false;
    }
    std::vector<Trial> trials = tryBest(problem_, settler_, present, evidence, candidates);
    int attempts = kMostAttempts;
    std::optional<Attempt> best = findServing(trials, standing, attempts);
    std::vector<RankedSet> ranked;
    if (best)
        ranked = weighRivals(*best, trials, standing, attempts);
    else
        for (const Trial& trial : trials) ranked.push_back({trial.set, trial.log_evidence});
    for (Trial& trial : trials)
        if (trial.set != present.set) standing.settled.insert_or_assign(trial.set, std::move(trial.point));
    weighFreshStarts(best, standing, ranked);
    const bool changed = best.has_value();
    if (changed) {
        carryRivals(standing, best->state.set, ranked);
        take(std::move(*best), standing);
    } else {
        keepRivals(standing, ranked);
        addLessLikely(standing.state.set, present_, fewer_, ranked);
    }
    sortByEvidence(ranked);
    standing.ranked = std::move(ranked);
    decision.action = changed ? "causes changed" : "nothing more to add, take away or exchange";
    decision.fitted = std::move(fitted_);
    return changed;
}

bool TolerantSearch::takeFewer(const Evidence& evidence, Standing& standing, Decision& decision) {
    begin(standing.state);
    std::optional<Attempt> fewer = findFewer(evidence, standing);
    if (fewer) {
        standing.ranked = {{fewer->state.set, fewer->log_evidence}, {standing.state.set, present_}};
        take(std::move(*fewer), standing);
    } else {
        addLessLikely(standing.state.set, present_, fewer_, standing.ranked);
        sortByEvidence(standing.ranked);
    }
    decision.action = fewer ? "causes changed" : "no cause is taken back";
    decision.fitted = fitted_;
    return fewer.has_value();
}

/// What the sets of a round are weighed against.
void TolerantSearch::begin(const SetState& present) {
    const Information all = sumOf(present.view, true);
    const std::vector<double> misfits = calcMisfits(all, problem_.estimateOf(present.point));
    excess_ = calcExcessOf(misfits);
    noise_alone_ = isNoiseAlone(all, misfits);
    present_ = settler_.calcLogEvidence(present);
    fitted_.clear();
    fewer_.clear();
}

/// The likeliest set with one cause less than the present one that is more so and serves: what was taken first may have
/// stood for what was taken after it, and only its own steps lead a set from where the other cause had a part.
std::optional<TolerantSearch::Attempt> TolerantSearch::findFewer(const Evidence& evidence, const Standing& standing) {
    const SetState& present = standing.state;
    std::optional<Attempt> best;
    for (const int h : present.set) {
        Trial trial{present.set, holdBack(problem_, present, h, evidence), 0};
        trial.set.erase(std::find(trial.set.begin(), trial.set.end(), h));
        if (!reached_.insert(trial.set).second) continue;
        tell("without a cause");
        const double least = best ? best->log_evidence : present_;
        Attempt attempt = settle(trial, present, least);
        if (best) compare(attempt, *best);
        if (!(attempt.log_evidence > least))
            fewer_.push_back({attempt.state.set, attempt.log_evidence});
        else if (serves(attempt, standing))
            best = std::move(attempt);
    }
    return best;
}

/// Whether some set would leave at most half of what exceeds the noise, by the quadratic, or that is little anyway.
bool TolerantSearch::isHopeful(const Evidence& evidence, const std::vector<RankedSet>& candidates,
                               const SetState& present) const {
    if (excess_ < kSatisfied - 1) return true;
    const Information all = sumOf(present.view, true);
    const auto last = candidates.begin() + static_cast<long>(std::min(kTried, candidates.size()));
    return std::any_of(candidates.begin(), last, [&](const RankedSet& entry) {
        return calcExcessOf(calcMisfits(all, evidence.solve(entry.members).mean)) < 0.5 * excess_;
    });
}

/// The likeliest set that is more so than the present one and serves.
/// @param[in,out] trials the present set first; then by their evidence, without those that were found wanting
/// @param[in,out] attempts how many sets may be settled
std::optional<TolerantSearch::Attempt> TolerantSearch::findServing(std::vector<Trial>& trials, const Standing& standing,
                                                                   int& attempts) {
    const double present = trials.front().log_evidence;
    std::sort(trials.begin(), trials.end(),
              [](const Trial& a, const Trial& b) { return a.log_evidence > b.log_evidence; });
    std::optional<Attempt> best;
    std::vector<Trial> left;
    for (Trial& trial : trials) {
        if (!best && trial.log_evidence > present) {
            if (attempts == 0) continue;
            --attempts;
            Attempt attempt = settle(trial, standing.state);
            if (!serves(attempt, standing)) continue;
            if (attempt.log_evidence > present_)
                best = std::move(attempt);
            else
                trial.log_evidence = present + attempt.log_evidence - present_;
        }
        left.push_back(std::move(trial));
    }
    trials = std::move(left);
    return best;
}

/// What the present state leaves hides what tells the best set from its rivals: as many as time allows are settled too,
/// first those of other causes. A place that was not settled may gain what another one of its cause did, but what is
/// only supposed of it does not make it likelier than the best one that was settled.
/// @param[in,out] best the likeliest one that serves
/// @param[in,out] trials the one of `best` first
std::vector<RankedSet> TolerantSearch::weighRivals(Attempt& best, std::vector<Trial>& trials, const Standing& standing,
                                                   int attempts) {
    const HypothesisSet& present = standing.state.set;
    const double most = trials.front().log_evidence, shift = best.log_evidence - most;
    std::map<std::string, double> shifts{{nameCauses(best.state.set), shift}};
    std::map<HypothesisSet, double> settled{{best.state.set, best.log_evidence}};
    std::set<HypothesisSet> wanting;  // judged: no alternatives
    for (const bool other_causes : {true, false})
        for (Trial& trial : trials) {
            const std::string causes = nameCauses(trial.set);
            if (attempts == 0 || trial.log_evidence < most - kUnlikely) break;
            if (trial.set == present || settled.count(trial.set) > 0) continue;
            if (other_causes && shifts.count(causes) > 0) continue;
            --attempts;
            tell("rival");
            Attempt rival = settle(trial, standing.state);
            compare(rival, best);
            settled[trial.set] = rival.log_evidence;
            double& gained = shifts.emplace(causes, rival.log_evidence - trial.log_evidence).first->second;
            gained = std::max(gained, rival.log_evidence - trial.log_evidence);
            trial.point = rival.state.point;
            if (rival.log_evidence <= best.log_evidence) continue;
            if (serves(rival, standing))
                best = std::move(rival);
            else
                wanting.insert(trial.set);
        }
    std::vector<RankedSet> ranked{{present, present_}};
    for (const Trial& trial : trials) {
        if (trial.set == present || wanting.count(trial.set) > 0) continue;
        const auto own = settled.find(trial.set);
        const auto alike = shifts.find(nameCauses(trial.set));
        const double supposed = trial.log_evidence + (alike != shifts.end() ? alike->second : shift);
        ranked.push_back({trial.set, own != settled.end() ? own->second : std::min(supposed, best.log_evidence)});
    }
    return ranked;
}

/// What begins far from the present state is settled and weighed against the best set, or against the present one.
void TolerantSearch::weighFreshStarts(std::optional<Attempt>& best, Standing& standing,
                                      std::vector<RankedSet>& ranked) {
    const SetState& reached = best ? best->state : standing.state;
    const std::vector<Trial> starts = startAfresh(problem_, settler_, standing.state, reached);
    if (starts.empty()) return;
    for (const Trial& start : starts) {
        tell("rival");
        const double least = best ? best->log_evidence : present_;
        Attempt fresh = settle(start, standing.state, best ? least - kUnlikely : least);
        if (best) compare(fresh, *best);
        const bool better = fresh.log_evidence > least;
        if (!(better || (best && fresh.log_evidence > least - kUnlikely)) || !serves(fresh, standing)) continue;
        if (!best) ranked = {{standing.state.set, present_}};
        ranked.push_back({start.set, fresh.log_evidence});
        standing.settled.insert_or_assign(start.set, fresh.state.point);
        if (better) best = std::move(fresh);
    }
}

void TolerantSearch::take(Attempt best, Standing& standing) {
    fitted_[best.record].outcome = kTaken;
    problem_.adopt(best.state.set);
    const HypothesisSet& before = standing.state.set;
    if (best.needed)
        for (const int h : best.state.set)
            if (!std::binary_search(before.begin(), before.end(), h)) needed_.push_back(h);
    standing.state = std::move(best.state);
    standing.judged = best.judged;
}

TolerantSearch::Attempt TolerantSearch::settle(const Trial& trial, const SetState& present,
                                               std::optional<double> rival) {
    const TestProblem::Memento before = problem_.adopt(trial.set);
    Attempt attempt;
    SetState& next = attempt.state;
    next.set = trial.set;
    // Rows count from new believed values and columns are others now.
    next.point = problem_.pointAt(problem_.estimateOf(trial.point), next.set);
    next.view = problem_.view(next.point, next.set);
    next.scales = settler_.scalesOf(calcMisfits(sumOf(next.view, true), problem_.estimateOf(next.point)));
    if (rival)
        settler_.compete(next, kMostAfresh, *rival);
    else
        settler_.settle(next, kMostRefining, true);
    attempt.log_evidence = present_ + calcLogOdds(problem_, settler_, next, present);
    attempt.needed = isNeeded(next) || (attempt.log_evidence > present_ + kUnlikely && isRelief(next, present));
    attempt.record = fitted_.size();
    fitted_.push_back({describe(problem_, next.set), attempt.log_evidence - present_, {}, kLessLikely});
    problem_.restore(before);
    return attempt;
}

/// Weighs a set against the best one directly: of what both gain over the present set, bursts of noise leave as much
/// unknown as the present set is far from either.
void TolerantSearch::compare(Attempt& attempt, const Attempt& best) {
    attempt.log_evidence = best.log_evidence + calcLogOdds(problem_, settler_, attempt.state, best.state);
    fitted_[attempt.record].log_evidence = attempt.log_evidence - present_;
}

/// Whether what a settled set adds lies beyond its tolerance and serves the prediction or the equations.
bool TolerantSearch::serves(Attempt& attempt, const Standing& standing) {
    const TestProblem::Memento before = problem_.adopt(attempt.state.set);
    attempt.judged = judge_(attempt.state.point, attempt.state.set);
    const char* const refusal = findRefusal(attempt, standing);
    problem_.restore(before);
    FittedSet& record = fitted_[attempt.record];
    record.error = attempt.judged.error;
    if (refusal) record.outcome = refusal;
    return !refusal;
}

const char* TolerantSearch::findRefusal(const Attempt& attempt, const Standing& standing) const {
    const SetState& next = attempt.state;
    const HypothesisSet& present = standing.state.set;
    if (!isPossible(problem_, next.set, problem_.estimateOf(next.point))) return kImpossible;
    bool must_improve = false, blames_sensor = false;
    for (const int h : next.set) {
        if (std::binary_search(present.begin(), present.end(), h)) continue;
        const Hypothesis& hypothesis = problem_.hypotheses()[h];
        if (!isBeyondTolerance(problem_, hypothesis, next.point)) return kWithin;
        const bool sensor = isSensorFault(hypothesis);
        blames_sensor = blames_sensor || sensor;
        must_improve = must_improve || (!attempt.needed && !sensor);
    }
    // What takes the place of other causes has to do as well as they do.
    if (must_improve && next.set.size() > present.size())
        return isImproved(standing.judged, attempt.judged) ? nullptr : "the prediction is no better with it";
    // A fault of sensors has no part in the prediction: whatever is worse with it was made up for by others.
    const bool spoilt = blames_sensor ? !(attempt.judged.error <= (1 + kWorth) * standing.judged.error)
                                      : isSpoilt(standing.judged, attempt.judged);
    // Where contact amplifies small differences, a prediction is some per cent better or worse by chance.
    return spoilt && (blames_sensor || !isWithinBand(attempt)) ? kSpoils : nullptr;
}

/// Whether noise and what its numbers leave open make as much of an attempt's prediction.
bool TolerantSearch::isWithinBand(const Attempt& attempt) const {
    const SetState& state = attempt.state;
    return band_ &&
           attempt.judged.error <=
               band_(state, makeEvidence(problem_, state.view, state.set, state.scales, true).calcPosterior(state.set));
}

/// Whether equations that leave more than noise leave half of what exceeds it with a set.
bool TolerantSearch::isNeeded(const SetState& next) const {
    return !noise_alone_ &&
           calcExcessOf(calcMisfits(sumOf(next.view, true), problem_.estimateOf(next.point))) < 0.5 * excess_;
}

/// Whether what numbers beyond their tolerances get back outweighs by far the prior odds of the causes that are added.
bool TolerantSearch::isRelief(const SetState& next, const SetState& present) const {
    double odds = 0;
    for (const int h : next.set)
        if (!std::binary_search(present.set.begin(), present.set.end(), h)) odds += problem_.hypotheses()[h].log_prior;
    return calcRelief(problem_, present, next) > kUnlikely - odds;
}

std::string TolerantSearch::nameCauses(const HypothesisSet& set) const {
    std::string names;
    for (const int h : set) names += problem_.hypotheses()[h].cause + " ";
    return names;
}

void TolerantSearch::tell(const std::string& text) const {
    if (progress_) progress_({text});
}

}  // namespace wems::identify::updating
