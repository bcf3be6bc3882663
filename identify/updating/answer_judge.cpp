#include "identify/updating/answer_judge.hpp"

#include <algorithm>

#include "identify/updating/remainder.hpp"
#include "identify/verdict/free_error.hpp"

namespace wems::identify::updating {

namespace {

constexpr unsigned kSeed = 20260101;  // of the draws of band and noise: the same answer again

/// Contract, section 6: more than band, noise and what is worth naming. The band of a run that amplifies small
/// differences is wide; it excuses nothing where the equations of motion are not satisfied either.
bool isLeft(const Selection& selection, double error, double band, double floor) {
    const bool satisfied = isSatisfied(selection.decisions.back().misfit);
    return (!(error <= band) || !satisfied) && isWorthExplaining({error, floor});
}

std::size_t findFirstJudging(const TestProblem& problem) {
    const std::size_t own = problem.identificationCount();
    return own < problem.runs().size() ? own : 0;
}

}  // namespace

AnswerJudge::AnswerJudge(const TestProblem& problem)
    : problem_(problem),
      first_judging_(findFirstJudging(problem)),
      own_(problem, 0, problem.identificationCount()),
      judging_(problem, first_judging_, problem.runs().size() - first_judging_) {}

FreeError AnswerJudge::predict(const TestPoint& point, const HypothesisSet& set) {
    FreeError judged = judging_.calcError(point, set);
    if (!driven_) driven_ = judging_.calcDriven(problem_.cleanModel(point), kSeed);
    judged.driven = *driven_;
    return judged;
}

double AnswerJudge::calcBand(const SetState& state, const Posterior& posterior) const {
    const double floor = judging_.calcNoiseFloor(problem_.cleanModel(state.point), kSeed);
    return calcBand(judging_, state.set, state.point, posterior, floor);
}

double AnswerJudge::calcBand(const FreeRuns& runs, const HypothesisSet& set, const TestPoint& point,
                             const Posterior& posterior, double floor) const {
    const FreeRuns::Corrected corrected = runs.correct(point, set);
    return calcPredictionBand(problem_, set, point, posterior, corrected.runs, runs.first(), floor, kSeed);
}

Judgement AnswerJudge::judge(const Selection& selection, const MountModel& believed) const {
    const auto errorOf = [&](const TestPoint& point, const HypothesisSet& set) -> GroupError {
        return {own_.calcError(point, set).error, judging_.calcError(point, set).error};
    };
    Judgement judgement;
    judgement.before = {own_.calcError(believed).error, judging_.calcError(believed).error};
    judgement.adjusted = errorOf(selection.adjusted, {});
    judgement.after = errorOf(selection.state.point, selection.state.set);
    const MountModel best = problem_.cleanModel(selection.state.point);
    judgement.noise_floor = {own_.calcNoiseFloor(best, kSeed), judging_.calcNoiseFloor(best, kSeed)};
    judgement.is_left = judgePrediction(selection, judgement);
    // The runs that the answer was found on must bear it out too: they may hold what no other run does.
    if (!judgement.is_left && isValidated()) judgement.is_left = judgeIdentification(selection, judgement);
    return judgement;
}

bool AnswerJudge::judgePrediction(const Selection& selection, Judgement& judgement) const {
    const double floor = judgement.noise_floor.validation, after = judgement.after.validation;
    const HypothesisSet& set = selection.state.set;
    const double fitted = judging_.calcError(selection.fitted, set).error;
    double& band = judgement.prediction_band;
    band = calcBand(judging_, set, selection.fitted, selection.fitted_noise, floor);
    if (isLeft(selection, std::min(fitted, after), band, floor)) return true;
    if (after <= band) return false;
    // What the identification runs never reached may still move the prediction: its band is wider.
    band = std::max(band, calcBand(judging_, set, selection.state.point, selection.noise, floor));
    return isLeft(selection, after, band, floor);
}

bool AnswerJudge::judgeIdentification(const Selection& selection, Judgement& judgement) const {
    const double floor = judgement.noise_floor.identification, after = judgement.after.identification;
    if (!isWorthExplaining({after, floor})) return false;
    // Where the equations of these very runs are left with noise, the simulation errs by what it amplifies.
    const Information& own = selection.state.view.identification;
    if (isNoiseAlone(own, calcMisfits(own, problem_.estimateOf(selection.state.point)))) return false;
    judgement.identification_band = calcBand(own_, selection.state.set, selection.state.point, selection.noise, floor);
    return isLeft(selection, after, *judgement.identification_band, floor);
}

}  // namespace wems::identify::updating
