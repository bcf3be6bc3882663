#include "identify/diagnose/selection.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "identify/diagnose/leftover.hpp"
#include "identify/diagnose/missing_mode.hpp"
#include "identify/diagnose/screening.hpp"
#include "identify/motion/parallel.hpp"

namespace wems::identify {
namespace {

/// Fits within this share of the smaller excess over a perfect model cannot be told apart.
constexpr double kTieFraction = 0.02;
/// … nor within this share of the least gain of the misfit per value.
constexpr double kTieGain = 0.25;

/// Where a force along one axis could make this share of the mount's residual, laws elsewhere are not tried …
constexpr double kAloneInEquation = 0.95;
/// … but for axes that could make nearly as much. The residual must stand out from the noise for that, per value.
constexpr double kNearlyAsMuch = 0.04;
constexpr double kStandsOut = 0.5;

/// Share of a stop's stiffness below which there is no stop.
constexpr double kNoStop = 0.02;

/// Fits with what follows the model, and what is left to change after them: the values in standard deviations, the
/// misfit relative.
constexpr int kFollowPasses = 4;
constexpr double kNearDeviations = 0.3, kSettled = 1e-3;

/// `1.x` of `1.x` and `1.x.+`; empty for `body`, `mobile`, …
std::string axisOf(const std::string& place) {
    const auto dot = place.find('.');
    return dot == std::string::npos ? "" : place.substr(0, dot + 2);
}

bool overlaps(const Candidate& a, const std::vector<Candidate>& others) {
    const auto names = a.parameterNames();
    for (const auto& other : others)
        for (const auto& name : other.parameterNames())
            if (std::find(names.begin(), names.end(), name) != names.end()) return true;
    return false;
}

std::size_t countCauses(const std::vector<Candidate>& candidates) {
    std::set<std::string> names;
    for (const auto& candidate : candidates) names.insert(candidate.cause);
    return names.size();
}

class Selector {
public:
    Selector(OpenLoopProblem& identification, OpenLoopProblem& validation, const MountModel& model,
             const SelectionOptions& options)
        : identification_(identification), validation_(validation), base_(model), options_(options) {
        with_bracket_ = false;
        for (std::size_t r = 0; r < identification.runs().size(); ++r)
            with_bracket_ = with_bracket_ || identification.hasBracket(r);
    }

    Selection run() {
        setReference(base_);
        laws_ = std::make_unique<LawDifferences>(identification_, base_);
        result_.fit = fitParameters(identification_, base_, {});
        forward();
        if (result_.accepted.size() > 1) exchange();
        removeIdle();
        split();
        estimateErrors();
        judge();
        result_.identification_before = identification_.calcMisfit(identification_.calcResidual(base_));
        result_.validation_before = validate(base_);
        result_.identification_after = result_.fit.misfit;
        result_.validation_after = validate(result_.fit.model);
        return std::move(result_);
    }

private:
    double validate(const MountModel& model) const { return validation_.calcMisfit(validation_.calcResidual(model)); }
    void tell(const std::string& text) const {
        if (options_.progress) options_.progress(text);
    }
    double price(double misfit_per_value) const {
        return 0.5 * std::log(static_cast<double>(identification_.size())) * std::max(1.0, misfit_per_value);
    }
    double score(const Trial& trial) const {
        const double best = std::max(1.0, trial.identification);
        return trial.identification * static_cast<double>(identification_.size()) +
               2 * price(best) * static_cast<double>(trial.candidate.knobs.size());
    }

    /// Of the validation runs, that a candidate is taken.
    double calcNeededGain(double validation_misfit) const {
        if (options_.judged_elsewhere) return -kTieGain * options_.least_gain;
        return std::max(options_.least_gain, options_.least_fraction * std::max(0.0, validation_misfit - 1));
    }

    /// The catalogue of a model, without laws at places that its residual excludes.
    std::vector<Candidate> makePossible(const ParameterFit& present) const {
        auto catalogue = makeCatalogue(present.model, with_bracket_);
        for (auto& candidate : makeMissingMode(identification_, present.model, present.residual))
            catalogue.push_back(std::move(candidate));
        const auto keepPossible = [&](const std::function<bool(const std::string&)>& isPossible) {
            catalogue.erase(std::remove_if(catalogue.begin(), catalogue.end(),
                                           [&](const Candidate& candidate) {
                                               return !std::all_of(candidate.where.begin(), candidate.where.end(),
                                                                   isPossible);
                                           }),
                            catalogue.end());
        };
        if (!options_.only_place.empty()) {
            keepPossible([&](const std::string& place) { return axisOf(place) == options_.only_place; });
            return catalogue;
        }
        if (calcMountExcess(identification_, present.residual) < kStandsOut) return catalogue;
        const auto shares = calcPlaceShares(identification_, present.model, present.residual);
        if (shares.front().share < kAloneInEquation) return catalogue;
        keepPossible([&](const std::string& place) {
            const std::string axis = axisOf(place);
            return axis.empty() || std::any_of(shares.begin(), shares.end(), [&](const PlaceShare& share) {
                       return share.name == axis && share.share > shares.front().share - kNearlyAsMuch;
                   });
        });
        return catalogue;
    }

    /// Screens the catalogue of `model` and fits the best jointly with `accepted`.
    std::vector<Trial> tryCandidates(const ParameterFit& present, const std::vector<Candidate>& accepted, int count) {
        const auto catalogue = makePossible(present);
        const double now = present.misfit;
        const auto screened =
            screenCandidates(identification_, *laws_, present.model, present.residual, catalogue, price(now));
        const double least = 0.25 * options_.least_gain * static_cast<double>(identification_.size());
        std::vector<const Screened*> chosen;
        for (const auto& entry : screened) {
            if (static_cast<int>(chosen.size()) >= count || entry.gain < least) break;
            if (!overlaps(catalogue[entry.candidate], accepted)) chosen.push_back(&entry);
        }
        std::vector<Trial> trials(chosen.size());
        std::vector<ParameterFit> new_fits(chosen.size());
        runParallel(chosen.size(), [&](std::size_t i) {
            const auto& candidate = catalogue[chosen[i]->candidate];
            MountModel start = present.model;
            candidate.apply(start, chosen[i]->values);
            auto all = accepted;
            all.push_back(candidate);
            new_fits[i] = fitParameters(identification_, start, collectKnobs(all), 6);
            auto& trial = trials[i];
            trial.candidate = candidate;
            for (const auto& knob : candidate.knobs) trial.values.push_back(knob.get(new_fits[i].model));
            trial.identification = new_fits[i].misfit;
            trial.validation = validate(new_fits[i].model);
        });
        for (auto& fit : new_fits) fits_.push_back(std::move(fit));
        std::vector<std::size_t> order(trials.size());
        for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
        std::sort(order.begin(), order.end(),
                  [&](std::size_t a, std::size_t b) { return score(trials[a]) < score(trials[b]); });
        std::vector<Trial> sorted;
        std::vector<ParameterFit> fits;
        const auto first = fits_.size() - trials.size();
        for (const auto i : order) {
            sorted.push_back(trials[i]);
            fits.push_back(std::move(fits_[first + i]));
        }
        fits_ = std::move(fits);
        return sorted;
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
            laws_ = std::make_unique<LawDifferences>(identification_, present);
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
            const auto k = static_cast<Eigen::Index>(i);
            const double deviation = scale * std::sqrt(std::max(0.0, result_.fit.covariance(k, k)));
            if (!(std::abs(result_.fit.values[i] - knobs[i].get(model)) <= kNearDeviations * deviation)) return false;
        }
        return true;
    }

    void forward() {
        for (int number = 0; number < options_.max_rounds; ++number) {
            Round round;
            round.identification_before = result_.fit.misfit;
            round.validation_before = validate(result_.fit.model);
            tell("round " + std::to_string(number + 1) + ": screening");
            const auto place = calcPlaceShares(identification_, result_.fit.model, result_.fit.residual).front();
            round.place = place.name;
            round.place_share = place.share;
            fits_.clear();
            round.trials = tryCandidates(result_.fit, result_.accepted, options_.trials);
            const double needed = calcNeededGain(round.validation_before);
            for (std::size_t i = 0; i < round.trials.size() && round.taken < 0; ++i) {
                const auto& trial = round.trials[i];
                auto all = result_.accepted;
                all.push_back(trial.candidate);
                if (countCauses(all) > static_cast<std::size_t>(options_.max_causes)) continue;
                const double gain_identification = round.identification_before - trial.identification;
                const double gain_validation = round.validation_before - trial.validation;
                if (i > 0 && !isTie(trial.identification, round.trials.front().identification)) break;
                if (gain_identification < options_.least_gain || gain_validation < needed) continue;
                round.taken = static_cast<int>(i);
            }
            round.reason = round.taken >= 0 ? options_.judged_elsewhere ? "taken, as the simulation judges" : "taken"
                           : round.trials.empty() ? "no candidate promises a gain"
                                                  : "no candidate gains enough on the validation runs";
            const bool go_on = round.taken >= 0;
            result_.rounds.push_back(round);
            if (!go_on) break;
            const auto taken = static_cast<std::size_t>(round.taken);
            tell("taken: " + round.trials[taken].candidate.describe());
            auto accepted = result_.accepted;
            accepted.push_back(round.trials[taken].candidate);
            adopt(accepted, fits_[taken].model);
        }
        fits_.clear();
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
            fits_.clear();
            const auto trials = tryCandidates(present, others, 4);
            setReference(result_.fit.model);
            if (trials.empty()) continue;
            const double now = result_.fit.misfit;
            if (trials.front().identification < now - options_.least_gain &&
                !isTie(trials.front().identification, now) && trials.front().validation < validate(result_.fit.model)) {
                others.push_back(trials.front().candidate);
                adopt(others, fits_.front().model);
            }
        }
        fits_.clear();
    }

    /// What the others make superfluous goes.
    void removeIdle() {
        for (std::size_t i = result_.accepted.size(); i-- > 0 && result_.accepted.size() > 1;) {
            auto others = result_.accepted;
            others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
            const auto fit = refit(others);
            const double validation = validate(result_.fit.model);
            if (fit.misfit - result_.fit.misfit < options_.least_gain ||
                validate(fit.model) - validation < calcNeededGain(validation)) {
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
            if (gain * static_cast<double>(identification_.size()) > 4 * price(now) * extra &&
                gain > options_.least_gain && validate(fit.model) < validate(result_.fit.model)) {
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
            const auto k = static_cast<Eigen::Index>(i);
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
            result_.without.push_back(validate(present.model));
            result_.models_without.push_back(present.model);
            tell("rivals of " + result_.accepted[i].describe());
            setReference(present.model);
            fits_.clear();
            const auto trials = tryCandidates(present, others, 8);
            setReference(result_.fit.model);
            std::vector<Trial> rivals;
            for (const auto& trial : trials) {
                if (!isSame(trial, result_.accepted[i]) && isTie(trial.identification, now)) rivals.push_back(trial);
            }
            result_.rivals.push_back(rivals);
        }
        fits_.clear();
    }

    OpenLoopProblem &identification_, &validation_;
    MountModel base_;
    SelectionOptions options_;
    std::unique_ptr<LawDifferences> laws_;
    bool with_bracket_ = false;
    Selection result_;
    std::vector<ParameterFit> fits_;
};

}  // namespace

std::vector<Knob> collectKnobs(const std::vector<Candidate>& candidates) {
    std::vector<Knob> knobs;
    for (const auto& candidate : candidates) knobs.insert(knobs.end(), candidate.knobs.begin(), candidate.knobs.end());
    return knobs;
}

Selection selectCauses(OpenLoopProblem& identification, OpenLoopProblem& validation, const MountModel& model,
                       const SelectionOptions& options) {
    return Selector(identification, validation, model, options).run();
}

}  // namespace wems::identify
