#include "identify/exact/selection.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "identify/exact/leftover.hpp"

namespace wems::identify {
namespace {

/// Fits within this share of the smaller excess over a perfect model cannot be told apart.
constexpr double kTieFraction = 0.02;
/// … nor within this share of the least gain of the misfit per value.
constexpr double kTieGain = 0.25;

/// Share of a stop's stiffness below which there is no stop.
constexpr double kNoStop = 0.02;

/// Fits with what follows the model, and what is left to change after them: the values in standard deviations, the
/// misfit relative.
constexpr int kFollowPasses = 4;
constexpr double kNearDeviations = 0.3, kSettled = 1e-3;

std::size_t countCauses(const std::vector<Candidate>& candidates) {
    std::set<std::string> names;
    for (const auto& candidate : candidates) names.insert(candidate.cause);
    return names.size();
}

class Selector {
public:
    Selector(OpenLoopProblem& identification, OpenLoopProblem& validation, const MountModel& model,
             const SelectionOptions& options)
        : identification_(identification),
          validation_(validation),
          base_(model),
          options_(options),
          trials_(identification, validation, {options.least_gain, options.only_place, options.excluded}) {}

    Selection run() {
        setReference(base_);
        trials_.lookAround(base_);
        result_.fit = fitParameters(identification_, base_, {});
        forward();
        if (result_.accepted.size() > 1) exchange();
        removeIdle();
        split();
        estimateErrors();
        judge();
        result_.identification_before = identification_.calcMisfit(base_);
        result_.validation_before = validation_.calcMisfit(base_);
        result_.identification_after = result_.fit.misfit;
        result_.validation_after = validation_.calcMisfit(result_.fit.model);
        return std::move(result_);
    }

private:
    void tell(const std::string& text) const {
        if (options_.progress) options_.progress(text);
    }
    /// Of the validation runs, that a candidate is taken.
    double calcNeededGain(double validation_misfit) const {
        if (options_.judged_elsewhere) return -kTieGain * options_.least_gain;
        return std::max(options_.least_gain, options_.least_fraction * std::max(0.0, validation_misfit - 1));
    }

    void setReference(const MountModel& model) {
        identification_.setReference(model);
        validation_.setReference(model);
    }

    /// A resonance that is new turns the noise of what drives it into noise of its own: its width and that noise follow
    /// each other. So do the values and the slow motion that was not measured, known to first order around a model.
    int countPasses() const {
        const bool new_mode = std::any_of(result_.accepted.begin(), result_.accepted.end(),
                                          [](const Candidate& c) { return c.new_mode.has_value(); });
        return new_mode || identification_.hasSlowBalance() ? kFollowPasses : 1;
    }

    /// Accepted causes change what the noise does to the equations, and the slow motion where it was not measured: they
    /// are fitted once more with their own.
    void adopt(std::vector<Candidate> accepted, const MountModel& model) {
        result_.accepted = std::move(accepted);
        const auto knobs = collectKnobs(result_.accepted);
        result_.fit.model = model;
        double before = 0;
        for (int pass = countPasses(); pass > 0; --pass) {
            const MountModel present = result_.fit.model;
            identification_.rewhiten(present);
            validation_.rewhiten(present);
            trials_.lookAround(present);
            result_.fit = fitParameters(identification_, present, knobs);
            setReference(result_.fit.model);
            if (isNear(present, knobs) && std::abs(before - result_.fit.misfit) < kSettled * result_.fit.misfit) break;
            before = result_.fit.misfit;
        }
    }

    /// True if the fit's values are those of `model`, well within their uncertainty.
    bool isNear(const MountModel& model, const std::vector<Knob>& knobs) const {
        const double scale = std::sqrt(std::max(1.0, result_.fit.misfit));
        for (std::size_t i = 0; i < knobs.size(); ++i) {
            const Eigen::Index k = i;
            const double deviation = scale * std::sqrt(std::max(0.0, result_.fit.covariance(k, k)));
            if (!(std::abs(result_.fit.values[i] - knobs[i].get(model)) <= kNearDeviations * deviation)) return false;
        }
        return true;
    }

    void forward() {
        for (int number = 0; number < options_.max_rounds; ++number) {
            SearchRound round;
            std::vector<Trial> trials;
            round.identification_before = result_.fit.misfit;
            round.validation_before = validation_.calcMisfit(result_.fit.model);
            tell("round " + std::to_string(number + 1) + ": screening");
            const auto place = calcPlaceShares(identification_, result_.fit.model, result_.fit.residual).front();
            round.place = place.name;
            round.place_share = place.share;
            const auto fitted = trials_.fitBest(result_.fit, result_.accepted, options_.trials);
            for (const auto& entry : fitted) {
                const Trial& trial = entry.trial;
                trials.push_back(trial);
                round.trials.push_back(
                    {trial.candidate.describe(), trial.values, trial.identification, trial.validation});
            }
            const double needed = calcNeededGain(round.validation_before);
            for (std::size_t i = 0; i < trials.size() && round.taken < 0; ++i) {
                const auto& trial = trials[i];
                auto all = result_.accepted;
                all.push_back(trial.candidate);
                if (countCauses(all) > static_cast<std::size_t>(options_.max_causes)) continue;
                const double gain_identification = round.identification_before - trial.identification;
                const double gain_validation = round.validation_before - trial.validation;
                if (i > 0 && !isTie(trial.identification, trials.front().identification)) break;
                if (gain_identification < options_.least_gain || gain_validation < needed) continue;
                round.taken = static_cast<int>(i);
            }
            round.reason = round.taken >= 0 ? options_.judged_elsewhere ? "taken, as the simulation judges" : "taken"
                           : trials.empty() ? "no candidate promises a gain"
                                            : "no candidate gains enough on the validation runs";
            const bool go_on = round.taken >= 0;
            result_.rounds.push_back(round);
            if (!go_on) break;
            const auto taken = static_cast<std::size_t>(round.taken);
            tell("taken: " + trials[taken].candidate.describe());
            auto accepted = result_.accepted;
            accepted.push_back(trials[taken].candidate);
            adopt(accepted, fitted[taken].fit.model);
        }
    }

    bool isTie(double a, double b) const {
        return std::abs(a - b) <
               std::max(kTieGain * options_.least_gain, kTieFraction * std::max(0.0, std::min(a, b) - 1));
    }

    ParameterFit refit(const std::vector<Candidate>& accepted) {
        MountModel start = base_;
        for (const auto& candidate : accepted) {
            std::vector<double> values;
            for (const auto& knob : candidate.knobs) values.push_back(knob.get(result_.fit.model));
            candidate.apply(start, values);
        }
        return fitParameters(identification_, start, collectKnobs(accepted));
    }

    /// A wrong first choice may have been taken before the others were known: each is tried against all others.
    void exchange() {
        for (std::size_t i = 0; i < result_.accepted.size(); ++i) {
            auto others = result_.accepted;
            others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
            const auto present = refit(others);
            tell("exchange of " + result_.accepted[i].describe());
            setReference(present.model);
            const auto fitted = trials_.fitBest(present, others, 4);
            setReference(result_.fit.model);
            if (fitted.empty()) continue;
            const auto& [best, fit] = fitted.front();
            const double now = result_.fit.misfit;
            if (best.identification < now - options_.least_gain && !isTie(best.identification, now) &&
                best.validation < validation_.calcMisfit(result_.fit.model)) {
                others.push_back(best.candidate);
                adopt(others, fit.model);
            }
        }
    }

    /// What the others make superfluous goes.
    void removeIdle() {
        for (std::size_t i = result_.accepted.size(); i-- > 0 && result_.accepted.size() > 1;) {
            auto others = result_.accepted;
            others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
            const auto fit = refit(others);
            const double validation = validation_.calcMisfit(result_.fit.model);
            if (fit.misfit - result_.fit.misfit < options_.least_gain ||
                validation_.calcMisfit(fit.model) - validation < calcNeededGain(validation)) {
                adopt(others, fit.model);
            }
        }
    }

    /// Values that were taken to be common to several places are set free where that pays.
    void split() {
        for (std::size_t i = 0; i < result_.accepted.size(); ++i) {
            auto all = result_.accepted;
            auto& candidate = all[i];
            std::vector<Knob> single;
            for (const auto& knob : candidate.knobs)
                for (const auto& name : knob.names) single.push_back(makeKnob(name));
            if (single.size() == candidate.knobs.size()) continue;
            const double extra = static_cast<double>(single.size() - candidate.knobs.size());
            candidate.knobs = single;
            candidate.linear = single.size();
            const auto fit = fitParameters(identification_, result_.fit.model, collectKnobs(all));
            const double gain = result_.fit.misfit - fit.misfit;
            const double now = fit.misfit;
            if (gain * static_cast<double>(identification_.size()) > 4 * trials_.price(now) * extra &&
                gain > options_.least_gain &&
                validation_.calcMisfit(fit.model) < validation_.calcMisfit(result_.fit.model)) {
                result_.accepted = all;
                result_.fit = fit;
                setReference(fit.model);
            }
        }
    }

    /// What noise alone does not explain between two sets of runs belongs into the intervals.
    void estimateErrors() {
        const auto knobs = collectKnobs(result_.accepted);
        if (knobs.empty()) return;
        const auto other = fitParameters(validation_, result_.fit.model, knobs, 4);
        const double scale = std::sqrt(std::max(1.0, result_.fit.misfit));
        for (std::size_t i = 0; i < knobs.size(); ++i) {
            const Eigen::Index k = i;
            const double variance = result_.fit.covariance(k, k) + other.covariance(k, k);
            const double difference = std::abs(other.values[i] - result_.fit.values[i]);
            const double discrepancy = variance > 0 ? std::max(1.0, difference / std::sqrt(variance)) : 1.0;
            result_.standard_errors.push_back(scale * discrepancy *
                                              std::sqrt(std::max(0.0, result_.fit.covariance(k, k))));
        }
    }

    /// True if a trial is the accepted cause in other words: a stop without stiffness is a stop that is removed.
    bool isSame(const Trial& trial, const Candidate& accepted) const {
        if (trial.candidate.where != accepted.where) return false;
        if (trial.candidate.cause == accepted.cause) return true;
        if (accepted.cause != "clearance" || !accepted.knobs.empty() || trial.candidate.cause != "stop_stiffness")
            return false;
        return trial.values.front() < kNoStop * trial.candidate.knobs.front().get(base_);
    }

    /// Rivals and the price of leaving each out.
    void judge() {
        const double now = result_.fit.misfit;
        for (std::size_t i = 0; i < result_.accepted.size(); ++i) {
            auto others = result_.accepted;
            others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
            const auto present = refit(others);
            result_.without.push_back(validation_.calcMisfit(present.model));
            result_.models_without.push_back(present.model);
            tell("rivals of " + result_.accepted[i].describe());
            setReference(present.model);
            const auto fitted = trials_.fitBest(present, others, options_.trials);
            setReference(result_.fit.model);
            std::vector<Trial> rivals;
            for (const auto& [trial, fit] : fitted)
                if (!isSame(trial, result_.accepted[i]) && isTie(trial.identification, now)) rivals.push_back(trial);
            result_.rivals.push_back(rivals);
        }
    }

    OpenLoopProblem &identification_, &validation_;
    MountModel base_;
    SelectionOptions options_;
    TrialFits trials_;
    Selection result_;
};

}  // namespace

Selection selectCauses(OpenLoopProblem& identification, OpenLoopProblem& validation, const MountModel& model,
                       const SelectionOptions& options) {
    return Selector(identification, validation, model, options).run();
}

}  // namespace wems::identify
