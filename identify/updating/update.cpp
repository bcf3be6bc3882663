#include "identify/updating/update.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "identify/updating/answer_judge.hpp"
#include "identify/updating/naming.hpp"
#include "identify/updating/other_form.hpp"
#include "identify/updating/remainder.hpp"
#include "identify/updating/test_problem.hpp"
#include "identify/verdict/free_error.hpp"
#include "models/common/error.hpp"

namespace wems::identify::updating {
namespace {

constexpr double kLargestDecibels = 120.0;
constexpr double kRivalProbability = 0.02;  // a set at least this likely makes its causes rivals
constexpr double kTold = 0.25;              // of the prior variance, which the recordings leave of a number
constexpr double kNoStop = 0.1;             // of the believed stiffness: a stop that soft is none

/// `body.center_of_gravity.z` → `z`, `body.mass` → `mass`, `load.gain` → `gain`; `mobile.1.a.rx` → `mobile.1.rx`.
std::string reportName(const std::string& name) {
    if (name.rfind("body.", 0) == 0 || name.rfind("load.", 0) == 0) return name.substr(name.rfind('.') + 1);
    const auto at = name.find(".a.r");
    return at == std::string::npos ? name : name.substr(0, at) + name.substr(at + 2);
}

std::string reportPlace(const std::string& place) {
    for (const std::string kind : {".a", ".all"})
        if (place.size() > kind.size() && place.compare(place.size() - kind.size(), kind.size(), kind) == 0)
            return place.substr(0, place.size() - kind.size());
    return place;
}

double toDecibel(double ratio) {
    return ratio > 0 ? std::clamp(20 * std::log10(ratio), -kLargestDecibels, kLargestDecibels) : 0;
}

}  // namespace

class ModelUpdate::Impl {
public:
    Impl(const TestProblem& problem, const MountModel& model, Numbers numbers, const DiagnosisOptions& options)
        : model_(model), options_(options), problem_(problem) {
        problem_.assume(numbers);
        for (const TestRun& run : problem_.runs())
            for (const auto& note : run.motion.notes)
                if (std::find(result_.notes.begin(), result_.notes.end(), note) == result_.notes.end())
                    result_.notes.push_back(note);
        result_.validated = judge_.isValidated();
    }

    void select() {
        const FreeJudge predict = [&](const TestPoint& point, const HypothesisSet& set) {
            return judge_.predict(point, set);
        };
        const BandJudge band = [&](const SetState& state, const Posterior& posterior) {
            return judge_.calcBand(state, posterior);
        };
        selection_ = selectCauses(problem_, predict, band, options_.progress);
        problem_.forgetCorrected();
    }

    bool asksForMore() const { return selection_.asks_for_more; }

    Diagnosis report() {
        tell("free simulations");
        result_.extended = problem_.cleanModel(selection_.state.point);
        addSensorFaults();
        simulate();
        addCauses();
        addAdjustments();
        judge();
        addSpectrum();
        result_.decisions = selection_.decisions;
        result_.elastic_laws = selection_.elastic_laws;
        result_.misfit_before = selection_.decisions.front().misfit.front();
        result_.misfit_after = selection_.decisions.back().misfit.front();
        return std::move(result_);
    }

private:
    void tell(const std::string& text) const {
        if (options_.progress) options_.progress({text});
    }
    const Hypothesis& at(int hypothesis) const { return problem_.hypotheses()[hypothesis]; }
    const Unknown& row(int index) const { return problem_.table()[index]; }

    void simulate() {
        tell("prediction band");
        const Judgement judgement = judge_.judge(selection_, model_);
        result_.error_before = judgement.before;
        result_.error_adjusted = judgement.adjusted;
        result_.error_after = judgement.after;
        result_.noise_floor = judgement.noise_floor;
        result_.prediction_band = judgement.prediction_band;
        result_.identification_band = judgement.identification_band;
        left_ = judgement.is_left;
    }

    CauseParameter makeParameter(int index, const Posterior& posterior, double value) const {
        const double width = kTwoSided95 * std::sqrt(std::max(0.0, posterior.covariance(index, index)));
        return {reportName(row(index).name), row(index).unit, value, value - width, value + width};
    }

    std::vector<CauseParameter> makeParameters(const Hypothesis& hypothesis, const TestPoint& point,
                                               const Posterior& posterior) const {
        std::vector<CauseParameter> parameters;
        if (hypothesis.cause == "load" && point.state.model.load &&
            point.state.model.load->gain_over_frequency.size() > 1) {
            // Columns of the load's gain over frequency come last.
            const auto& gains = point.state.model.load->gain_over_frequency;
            Eigen::Index column = posterior.covariance.rows() - static_cast<Eigen::Index>(gains.size());
            for (const auto& [frequency, gain] : gains) {
                char name[40];
                std::snprintf(name, sizeof name, "gain at %.4g Hz", frequency);
                const double width = kTwoSided95 * std::sqrt(std::max(0.0, posterior.covariance(column, column)));
                parameters.push_back({name, "-", gain, gain - width, gain + width});
                ++column;
            }
            return parameters;
        }
        if (isCommonFault(hypothesis)) {
            for (const Direction& direction : hypothesis.directions)
                parameters.push_back(makeCommonFault(hypothesis, direction, point, posterior));
            return parameters;
        }
        for (const int index : hypothesis.reported)
            parameters.push_back(makeParameter(index, posterior, point.values[index]));
        return parameters;
    }

    /// One gain or delay of several channels, one rotation of several triaxes.
    static bool isCommonFault(const Hypothesis& hypothesis) {
        if (!isSensorFault(hypothesis)) return false;
        return hypothesis.reported.size() > hypothesis.directions.size();
    }

    /// The mean over the channels, each of which has its tolerance too.
    CauseParameter makeCommonFault(const Hypothesis& hypothesis, const Direction& direction, const TestPoint& point,
                                   const Posterior& posterior) const {
        std::vector<int> rows;
        for (const auto& [column, weight] : direction) rows.push_back(column);
        const double count = static_cast<double>(rows.size());
        const double value = point.values(rows).sum() / count;
        const double width = kTwoSided95 * std::sqrt(std::max(0.0, posterior.covariance(rows, rows).sum())) / count;
        const Unknown& first = row(rows.front());
        const std::string key = first.name.substr(first.name.rfind('.'));
        return {reportPlace(hypothesis.where.front()) + key, first.unit, value, value - width, value + width};
    }

    /// A stop without stiffness is none: its clearance is null.
    bool isRemovedStop(const Hypothesis& hypothesis) const {
        return hypothesis.cause == "stop_stiffness" && hypothesis.reported.size() == 1 &&
               selection_.state.point.values[hypothesis.reported.front()] <
                   kNoStop * row(hypothesis.reported.front()).believed;
    }

    void addCauses() {
        for (std::size_t i = 0; i < selection_.state.set.size(); ++i) {
            const Hypothesis& hypothesis = at(selection_.state.set[i]);
            Cause cause;
            cause.cause = hypothesis.cause;
            for (const auto& place : hypothesis.where) cause.where.push_back(reportPlace(place));
            cause.parameters = makeParameters(hypothesis, selection_.state.point, selection_.posterior);
            if (isRemovedStop(hypothesis)) {
                cause.cause = "clearance";
                const double none = std::numeric_limits<double>::quiet_NaN();
                cause.parameters = {{hypothesis.where.front() + ".clearance", "m", none, none, none}};
            }
            cause.probability =
                std::min(0.999, selection_.probabilityOf(selection_.state.set[i]) + addRivals(i, cause));
            const Evidence own =
                makeEvidence(problem_, selection_.state.view, selection_.state.set, selection_.state.scales, false);
            const TestPoint held = holdBack(problem_, selection_.state, selection_.state.set[i], own);
            const double error = judge_.judging().calcError(held, selection_.state.set).error;
            cause.gain_db = std::isfinite(error) ? toDecibel(error / result_.error_after.validation) : kLargestDecibels;
            const double before = result_.error_before.validation, after = result_.error_after.validation;
            cause.share =
                before > after
                    ? std::clamp((error * error - after * after) / (before * before - after * after), 0.0, 1.0)
                    : 0;
            merge(cause);
        }
        std::stable_sort(result_.causes.begin(), result_.causes.end(),
                         [](const Cause& a, const Cause& b) { return a.gain_db > b.gain_db; });
    }

    /// Causes that could stand in the place of one; returns the probability of the same statement in other words (the
    /// same cause at the same place, or at more places by one factor).
    double addRivals(std::size_t member, Cause& cause) const {
        HypothesisSet others = selection_.state.set;
        const int own = others[member];
        others.erase(others.begin() + static_cast<long>(member));
        double same = 0, all = 0;
        for (const RankedSet& entry : selection_.ranked)
            all += std::exp(entry.log_evidence - selection_.ranked.front().log_evidence);
        for (const RankedSet& entry : selection_.ranked) {
            const double probability = std::exp(entry.log_evidence - selection_.ranked.front().log_evidence) / all;
            if (std::binary_search(entry.members.begin(), entry.members.end(), own)) continue;
            // Sets of the same others, with one more of another name.
            HypothesisSet joined;
            std::set_difference(entry.members.begin(), entry.members.end(), others.begin(), others.end(),
                                std::back_inserter(joined));
            if (joined.size() != 1 || entry.members.size() != selection_.state.set.size()) continue;
            const Hypothesis& rival = at(joined.front());
            if (rival.cause == at(own).cause && sharesPlace(rival, at(own))) {
                same += probability;
                continue;
            }
            if (probability < kRivalProbability) continue;
            const Posterior posterior = fullEvidence().calcPosterior(entry.members);
            const auto settled = selection_.settled.find(entry.members);
            const TestPoint point =
                settled != selection_.settled.end() ? settled->second : problem_.pointAt(posterior.mean, entry.members);
            std::vector<std::string> where;
            for (const auto& place : rival.where) where.push_back(reportPlace(place));
            cause.rivals.push_back({rival.cause, where, makeParameters(rival, point, posterior),
                                    findSeparatingRun(cause.cause, rival.cause)});
        }
        return same;
    }

    /// With the columns of all hypotheses: the state's own view may have those of its set alone.
    const Evidence& fullEvidence() const {
        if (!full_evidence_)
            full_evidence_.emplace(makeEvidence(problem_, problem_.view(selection_.state.point), selection_.state.set,
                                                selection_.state.scales, false));
        return *full_evidence_;
    }

    static bool sharesPlace(const Hypothesis& a, const Hypothesis& b) {
        return std::any_of(a.where.begin(), a.where.end(), [&](const std::string& place) {
            return std::find(b.where.begin(), b.where.end(), place) != b.where.end();
        });
    }

    void merge(const Cause& cause) {
        const auto known = std::find_if(result_.causes.begin(), result_.causes.end(),
                                        [&](const Cause& other) { return other.cause == cause.cause; });
        if (known == result_.causes.end()) {
            result_.causes.push_back(cause);
            return;
        }
        for (const auto& place : cause.where)
            if (std::find(known->where.begin(), known->where.end(), place) == known->where.end())
                known->where.push_back(place);
        known->parameters.insert(known->parameters.end(), cause.parameters.begin(), cause.parameters.end());
        known->rivals.insert(known->rivals.end(), cause.rivals.begin(), cause.rivals.end());
        known->gain_db = std::max(known->gain_db, cause.gain_db);
        known->share = std::max(known->share, cause.share);
        known->probability = std::max(known->probability, cause.probability);
    }

    bool isOfCause(int index) const {
        return std::any_of(selection_.state.set.begin(), selection_.state.set.end(), [&](int h) {
            const auto& rows = at(h).reported;
            return std::find(rows.begin(), rows.end(), index) != rows.end();
        });
    }

    void addAdjustments() {
        for (std::size_t i = 0; i < problem_.table().size(); ++i) {
            const Unknown& number = problem_.table()[i];
            const int index = static_cast<int>(i);
            if (!(number.deviation > 0) || isOfCause(index)) continue;
            const double value = selection_.state.point.values[index];
            Adjustment adjustment{makeParameter(index, selection_.posterior, value), number.believed,
                                  2 * number.deviation};
            adjustment.parameter.name = number.name;
            if (value == number.believed) continue;
            // What the recordings do not know twice as well as it was believed only follows the others.
            if (selection_.posterior.covariance(index, index) > kTold * number.deviation * number.deviation) continue;
            result_.adjustments.push_back(adjustment);
        }
    }

    /// Faults of sensors that are causes, as the extended model states them.
    void addSensorFaults() {
        const auto faultOf = [&](const std::string& channel) -> SensorFault& {
            for (auto& fault : result_.extended.sensors)
                if (fault.channel == channel) return fault;
            result_.extended.sensors.emplace_back();
            result_.extended.sensors.back().channel = channel;
            return result_.extended.sensors.back();
        };
        for (const int h : selection_.state.set)
            for (const int index : at(h).reported) {
                const Unknown& number = row(index);
                const double value = selection_.state.point.values[index];
                const auto& layout = problem_.layout();
                if (number.kind == UnknownKind::channel_gain) faultOf(layout.channels[number.first].name).gain = value;
                if (number.kind == UnknownKind::channel_delay)
                    faultOf(layout.channels[number.first].name).delay = value;
                if (number.kind == UnknownKind::triax_rotation)
                    faultOf(nameTriax(number.first)).rotation[number.second] = value;
            }
    }

    /// As a model's sensor names it: the place, where only one kind of channel was recorded there.
    std::string nameTriax(int triax) const {
        const auto& triaxes = problem_.layout().triaxes;
        const std::string& name = triaxes[triax].name;
        std::string place = reportPlace(name);
        const auto here = [&](const SensorTriax& other) { return reportPlace(other.name) == place; };
        if (std::count_if(triaxes.begin(), triaxes.end(), here) == 1) return place;
        return name == place ? place + ".d" : name;
    }

    void judge() {
        const double after = result_.error_after.validation;
        const bool worse =
            !selection_.state.set.empty() && after > result_.error_before.validation && after > kLeastError;
        if (left_ || worse) {
            result_.verdict = Diagnosis::Verdict::unexplained;
            result_.unexplained_where =
                locateRemainder(selection_.state.view, selection_.decisions.back().misfit, result_.extended);
            // Is it a force of the displacement alone? A cause that had another form has told so.
            for (const std::string& place : result_.unexplained_where)
                if (result_.elastic_laws.empty())
                    result_.elastic_laws = findElasticLaw(problem_, Settler(problem_), selection_.state, place);
        } else {
            result_.verdict =
                selection_.state.set.empty() ? Diagnosis::Verdict::nothing_missing : Diagnosis::Verdict::explained;
        }
    }

    /// Of the mount's equation along the runs that judge, as believed and as answered.
    void addSpectrum() {
        result_.spectrum = calcMisfitSpectrum(problem_.viewAlone(problem_.believedPoint()), selection_.state.view,
                                              judge_.firstJudging());
    }

    MountModel model_;
    DiagnosisOptions options_;
    TestProblem problem_;
    AnswerJudge judge_{problem_};
    Selection selection_;
    mutable std::optional<Evidence> full_evidence_;
    bool left_ = false;  // more than the band, the noise and what is worth naming
    Diagnosis result_;
};

ModelUpdate::ModelUpdate(const TestProblem& problem, const MountModel& model, Numbers numbers,
                         const DiagnosisOptions& options)
    : impl_(std::make_unique<Impl>(problem, model, numbers, options)) {}

ModelUpdate::~ModelUpdate() = default;

void ModelUpdate::select() {
    impl_->select();
}

bool ModelUpdate::asksForMore() const {
    return impl_->asksForMore();
}

Diagnosis ModelUpdate::report() {
    return impl_->report();
}

}  // namespace wems::identify::updating
