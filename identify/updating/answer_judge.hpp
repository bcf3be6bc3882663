/// @file
/// What free simulations say of an answer: how it errs on the runs that it was found on and on those that judge it, and
/// whether noise and what is not known of the numbers allow that.
#pragma once

#include <optional>

#include "identify/updating/free_runs.hpp"
#include "identify/updating/selection.hpp"
#include "identify/updating/test_problem.hpp"
#include "identify/verdict/diagnosis.hpp"

namespace wems::identify::updating {

struct Judgement {
    GroupError before, adjusted, after, noise_floor;
    double prediction_band = 0;                 ///< error that noise and the posterior allow the judging runs, 95 %
    std::optional<double> identification_band;  ///< the same of the identification runs, where it was asked for
    bool is_left = false;                       ///< more than band, noise and what is worth naming
};

class AnswerJudge {
public:
    /// @param problem must outlive this; its validation runs judge, or all where there are none
    explicit AnswerJudge(const TestProblem& problem);

    bool isValidated() const { return first_judging_ > 0; }
    std::size_t firstJudging() const { return first_judging_; }
    const FreeRuns& judging() const { return judging_; }

    /// Error of the judging runs, with what the noise of the drive makes of it: that is of the first model asked for,
    /// and changes little from one to another.
    FreeError predict(const TestPoint& point, const HypothesisSet& set);
    /// Of the judging runs about a state.
    double calcBand(const SetState& state, const Posterior& posterior) const;

    Judgement judge(const Selection& selection, const MountModel& believed) const;

private:
    double calcBand(const FreeRuns& runs, const HypothesisSet& set, const TestPoint& point, const Posterior& posterior,
                    double floor) const;
    /// Whether the prediction leaves something; fills in its band.
    bool judgePrediction(const Selection& selection, Judgement& judgement) const;
    bool judgeIdentification(const Selection& selection, Judgement& judgement) const;

    const TestProblem& problem_;
    std::size_t first_judging_;
    FreeRuns own_, judging_;
    std::optional<DrivenNoise> driven_;
};

}  // namespace wems::identify::updating
