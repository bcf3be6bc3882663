#include "identify/diagnose/diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "identify/catalogue/hypotheses.hpp"
#include "identify/diagnose/acceleration_faults.hpp"
#include "identify/diagnose/judge.hpp"
#include "identify/diagnose/leftover.hpp"
#include "identify/diagnose/pass.hpp"
#include "identify/fit/intervals.hpp"
#include "identify/updating/update.hpp"
#include "models/error.hpp"
#include "models/parameter_access.hpp"

namespace wems::identify {

namespace {

constexpr int kPasses = 3;

/// Moves the faults of whole sides, which a pass knows to first order only, to the list that is corrected exactly.
bool moveSideFaults(const Selection& selection, std::vector<ChannelFault>& faults) {
    bool moved = false;
    Eigen::Index first = 0;
    for (const auto& candidate : selection.accepted) {
        const Eigen::Index own = first;
        first += static_cast<Eigen::Index>(candidate.knobs.size());
        if (candidate.cause.rfind("sensor_", 0) != 0) continue;
        moved = true;
        const std::string& side = candidate.where.front();
        auto known = std::find_if(faults.begin(), faults.end(), [&](const ChannelFault& fault) {
            return fault.cause == candidate.cause && fault.fault.channel == side;
        });
        if (known == faults.end()) {
            ChannelFault fault;
            fault.cause = candidate.cause;
            fault.fault.channel = side;
            known = faults.insert(faults.end(), fault);
        }
        const double error = std::sqrt(std::max(0.0, selection.fit.covariance(own, own)));
        for (const auto& sensor : selection.fit.model.sensors) {
            if (sensor.channel != side) continue;
            if (candidate.cause == "sensor_gain") {
                known->fault.gain *= sensor.gain;
                known->gain_error = error;
            } else if (candidate.cause == "sensor_delay") {
                known->fault.delay += sensor.delay;
                known->delay_error = error;
            } else {
                known->fault.rotation += sensor.rotation;
                known->rotation_error = error;
            }
        }
    }
    return moved;
}

/// Of each cause what its gain says: the validation error without it, all others refitted.
void addShares(Diagnosis& result) {
    const double before = result.error_before.validation, after = result.error_after.validation;
    for (Cause& cause : result.causes) {
        const double without = after * std::pow(10, cause.gain_db / 20);
        cause.share =
            before > after
                ? std::clamp((without * without - after * after) / (before * before - after * after), 0.0, 1.0)
                : 0;
    }
}

/// With every number of the model and of the sensors exactly known but for the causes.
Diagnosis diagnoseExact(const std::vector<Recording>& identification, const std::vector<Recording>& validation,
                        const MountModel& model, const DiagnosisOptions& options) {
    const auto tell = [&](const std::string& text) {
        if (options.progress) options.progress(text);
    };
    Diagnosis result;
    result.validated = !validation.empty();
    const auto& judges = result.validated ? validation : identification;
    tell("consistency of the channels");
    std::vector<Recording> all = identification;
    all.insert(all.end(), validation.begin(), validation.end());
    auto faults = findChannelFaults(all, model, kGainScatter);
    SelectionOptions selection_options;
    selection_options.progress = options.progress;
    tell("equations of motion");
    auto pass = std::make_unique<Pass>(identification, judges, faults, model, selection_options);
    for (int number = 1; number < kPasses && moveSideFaults(pass->selection, faults); ++number) {
        tell("equations of motion with corrected channels");
        pass = std::make_unique<Pass>(identification, judges, faults, model, selection_options);
    }
    for (const auto& motion : pass->fit_group.motions)
        for (const auto& note : motion.notes)
            if (std::find(result.notes.begin(), result.notes.end(), note) == result.notes.end())
                result.notes.push_back(note);
    const auto on_accelerations = findAccelerationFaults(correctFaults(identification, faults, faults.size()),
                                                         pass->fit_group.motions, model, kGainScatter);
    tell("free simulations");
    judgeBySimulation(*pass, model, identification, judges, faults, on_accelerations, result);
    pass->judge_problem.setReference(model);
    result.spectrum.before = calcMisfitByFrequency(pass->judge_problem, pass->judge_problem.calcResidual(model));
    result.spectrum.after =
        calcMisfitByFrequency(pass->judge_problem, pass->judge_problem.calcResidual(pass->selection.fit.model));
    for (std::size_t i = 0; i < result.spectrum.before.size(); ++i)
        result.spectrum.frequency.push_back(static_cast<double>(i) + 0.5);
    result.misfit_before = pass->selection.validation_before;
    result.misfit_after = pass->selection.validation_after;
    result.rounds = pass->selection.rounds;
    result.error_adjusted = result.error_before;
    addShares(result);
    return result;
}

/// Whether a model states that all of its numbers, and those of its sensors, are exactly known.
bool isExactlyKnown(const MountModel& model) {
    for (std::size_t i = 0; i < kToleranceKeys.size(); ++i)
        if (model.tolerances.find(static_cast<ToleranceOf>(i)) != 0.0) return false;
    return true;
}

/// With every number anywhere within its tolerance. Nothing where the recordings cannot be judged so.
std::optional<Diagnosis> diagnoseWithTolerances(const std::vector<Recording>& identification,
                                                const std::vector<Recording>& validation, const MountModel& model,
                                                const DiagnosisOptions& options) {
    if (isExactlyKnown(model)) return std::nullopt;
    try {
        return updating::updateModel(identification, validation, model, options);
    } catch (const InputError&) {  // said by the step with exact numbers too, in the terms of its own needs
        return std::nullopt;
    }
}

/// A verdict never contradicts its figures: where the simulation errs by as much as one in which nothing moves, the
/// model answers for nothing, whatever noise and posterior would excuse.
Diagnosis checkVerdict(Diagnosis result, const MountModel& model) {
    constexpr double still = 1;
    const double error = std::max(result.error_after.identification, result.error_after.validation);
    if (error < still || result.verdict == Diagnosis::Verdict::unexplained) return result;
    result.verdict = Diagnosis::Verdict::unexplained;
    for (const Connection& connection : model.connections)
        for (std::size_t a = 0; a < 3; ++a)
            if (connection.axis[a].stiffness > 0) result.unexplained_where.push_back(connection.name + "." + "xyz"[a]);
    return result;
}

}  // namespace

Diagnosis diagnose(const std::vector<Recording>& identification, const std::vector<Recording>& validation,
                   const MountModel& model, const DiagnosisOptions& options) {
    if (identification.empty()) throw InputError({}, "no recording to diagnose", "at least one CSV file");
    // The simplest world first: exact numbers and a cause or two. Where that leaves something, nothing is exact.
    Diagnosis exact = checkVerdict(diagnoseExact(identification, validation, model, options), model);
    if (exact.verdict != Diagnosis::Verdict::unexplained) return exact;
    auto adjusted = diagnoseWithTolerances(identification, validation, model, options);
    if (adjusted) adjusted = checkVerdict(std::move(*adjusted), model);
    // Of two answers that leave something, the one that predicts better.
    if (!adjusted || (adjusted->verdict == Diagnosis::Verdict::unexplained &&
                      exact.error_after.validation <= adjusted->error_after.validation))
        return exact;
    return std::move(*adjusted);
}

std::string formatVerdict(Diagnosis::Verdict verdict) {
    switch (verdict) {
        case Diagnosis::Verdict::explained:
            return "explained";
        case Diagnosis::Verdict::nothing_missing:
            return "nothing_missing";
        case Diagnosis::Verdict::unexplained:
            return "unexplained";
    }
    return {};
}

namespace {

constexpr double kConvincing = 4.0;    // excess without a cause over that with it, where much is left unexplained
constexpr double kSystematic = 0.002;  // of a value: calibration, smoothing, sampling; half of a 95 % interval
constexpr double kCertain = 0.999;
constexpr double kLargestDecibels = 120.0;  // dB

/// `body.center_of_gravity.z` → `z`, `body.mass` → `mass`, `load.gain` → `gain`; the others as they are.
std::string reportName(const std::string& name) {
    if (name.rfind("body.", 0) == 0 || name.rfind("load.", 0) == 0) return name.substr(name.rfind('.') + 1);
    return name;
}

CauseParameter makeParameter(const std::string& name, double value, double half_width) {
    return {reportName(name), parameterUnit(name), value, value - half_width, value + half_width};
}

double toDecibel(double ratio) {
    if (!(ratio > 0)) return 0;
    return std::clamp(20 * std::log10(ratio), -kLargestDecibels, kLargestDecibels);
}

std::vector<CauseParameter> makeParameters(const Candidate& candidate, const MountModel& model,
                                           const std::vector<double>& half_widths) {
    std::vector<CauseParameter> parameters;
    for (const auto& entry : candidate.fixed)
        parameters.push_back(makeParameter(entry.first, std::numeric_limits<double>::quiet_NaN(), 0));
    // A stop that was missing: clearance first, as results name it.
    for (std::size_t k = candidate.knobs.size(); k-- > 0;) {
        const auto& knob = candidate.knobs[k];
        for (std::size_t i = knob.names.size(); i-- > 0;) {
            const double value = getParameter(model, knob.names[i]);
            const double width =
                half_widths.empty()
                    ? 0
                    : std::hypot(half_widths[k] * (knob.isFactor() ? knob.base[i] : 1.0), kSystematic * value);
            parameters.push_back(makeParameter(knob.names[i], value, width));
        }
    }
    if (candidate.cause != "clearance") std::reverse(parameters.begin(), parameters.end());
    return parameters;
}

/// `mobile.1.a` (a triax of accelerometers) is reported by the name of its connection.
std::string channelName(const std::string& channel) {
    const auto size = channel.size();
    return size > 2 && channel.compare(size - 2, 2, ".a") == 0 ? channel.substr(0, size - 2) : channel;
}

void sortByGain(std::vector<Cause>& causes) {
    std::stable_sort(causes.begin(), causes.end(),
                     [](const Cause& a, const Cause& b) { return a.gain_db > b.gain_db; });
}

}  // namespace

void addSensorCause(const ChannelFault& fault, double error_ratio, bool unexplained, std::vector<Cause>& causes) {
    Cause cause;
    cause.cause = fault.cause;
    const bool side = fault.fault.channel.find('.') == std::string::npos;
    cause.probability = unexplained && side && error_ratio < std::sqrt(kConvincing) ? kDoubtful : kCertain;
    cause.gain_db = toDecibel(error_ratio);
    const std::string channel = channelName(fault.fault.channel);
    cause.where = {channel};
    const double quantile = studentQuantile95(1e6);
    if (fault.cause == "sensor_gain") {
        cause.parameters = {makeParameter(channel + ".gain", fault.fault.gain, quantile * fault.gain_error)};
    } else if (fault.cause == "sensor_delay") {
        cause.parameters = {makeParameter(channel + ".delay", fault.fault.delay, quantile * fault.delay_error)};
    } else {
        for (int a = 0; a < 3; ++a)
            cause.parameters.push_back(
                makeParameter(channel + ".r" + "xyz"[a], fault.fault.rotation[a], quantile * fault.rotation_error));
    }
    const auto known =
        std::find_if(causes.begin(), causes.end(), [&](const Cause& c) { return c.cause == cause.cause; });
    if (known == causes.end()) {
        causes.push_back(cause);
    } else if (std::find(known->where.begin(), known->where.end(), channel) == known->where.end()) {
        known->where.push_back(channel);
        known->parameters.insert(known->parameters.end(), cause.parameters.begin(), cause.parameters.end());
        known->gain_db = std::max(known->gain_db, cause.gain_db);
    }
    sortByGain(causes);
}

std::vector<Cause> makeCauseReports(const Selection& selection, const std::vector<Judgement>& without,
                                    const Judgement& after, bool unexplained) {
    std::vector<Cause> causes;
    const double left = std::max(after.misfit - 1, 0.05);
    const double quantile = studentQuantile95(1e6);
    auto error = selection.standard_errors.begin();
    for (std::size_t i = 0; i < selection.accepted.size(); ++i) {
        const auto& candidate = selection.accepted[i];
        std::vector<double> half_widths;
        for (std::size_t k = 0; k < candidate.knobs.size(); ++k) half_widths.push_back(quantile * *error++);
        Cause cause;
        cause.cause = candidate.cause;
        cause.where = candidate.where;
        cause.parameters = makeParameters(candidate, selection.fit.model, half_widths);
        cause.gain_db = toDecibel(without[i].error / after.error);
        const double ratio = (without[i].misfit - 1) / left;
        cause.probability = unexplained && ratio < kConvincing ? kDoubtful : std::min(kCertain, 1 - 0.5 / (1 + ratio));
        for (const auto& rival : selection.rivals[i]) {
            MountModel model = selection.models_without[i];
            rival.candidate.apply(model, rival.values);
            cause.rivals.push_back({rival.candidate.cause, rival.candidate.where,
                                    makeParameters(rival.candidate, model, {}),
                                    updating::findSeparatingRun(candidate.cause, rival.candidate.cause)});
        }
        if (!cause.rivals.empty()) cause.probability = std::min(cause.probability, 0.6);
        const auto known =
            std::find_if(causes.begin(), causes.end(), [&](const Cause& c) { return c.cause == cause.cause; });
        if (known == causes.end()) {
            causes.push_back(cause);
            continue;
        }
        known->where.insert(known->where.end(), cause.where.begin(), cause.where.end());
        known->parameters.insert(known->parameters.end(), cause.parameters.begin(), cause.parameters.end());
        known->rivals.insert(known->rivals.end(), cause.rivals.begin(), cause.rivals.end());
        known->gain_db = std::max(known->gain_db, cause.gain_db);
        known->probability = std::max(known->probability, cause.probability);
    }
    for (auto& cause : causes) {
        std::sort(cause.where.begin(), cause.where.end());
        cause.where.erase(std::unique(cause.where.begin(), cause.where.end()), cause.where.end());
    }
    std::stable_sort(causes.begin(), causes.end(),
                     [](const Cause& a, const Cause& b) { return a.gain_db > b.gain_db; });
    return causes;
}

}  // namespace wems::identify
