#include "identify/diagnose/diagnose.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "identify/diagnose/believed_sensors.hpp"
#include "identify/updating/settling.hpp"
#include "identify/updating/update.hpp"
#include "identify/verdict/free_error.hpp"
#include "models/common/error.hpp"
#include "models/model_tolerance.hpp"
#include "models/sensor_reading.hpp"

namespace wems::identify {

namespace {

/// With every number anywhere within its tolerance. Nothing where the recordings cannot be judged so.
std::optional<Diagnosis> diagnoseWithTolerances(const updating::TestProblem& problem, const MountModel& model,
                                                const DiagnosisOptions& options) {
    if (problem.exactlyKnown()) return std::nullopt;
    try {
        updating::ModelUpdate update(problem, model, updating::Numbers::within_tolerances, options);
        update.select();
        return update.report();
    } catch (const InputError&) {  // said by the step with exact numbers too, in the terms of its own needs
        return std::nullopt;
    }
}

/// Whether all equations leave noise alone, whatever a sensitive prediction makes of what is not known.
bool satisfiesEquations(const Diagnosis& diagnosis) {
    return updating::isSatisfied(diagnosis.decisions.back().misfit);
}

/// Whether a number lies beyond its tolerance by its whole interval though no cause names it: that is no adjustment.
bool leavesOneBeyond(const Diagnosis& diagnosis) {
    const auto isNamed = [&](const std::string& name) {
        return std::any_of(diagnosis.causes.begin(), diagnosis.causes.end(), [&](const auto& cause) {
            return std::any_of(cause.parameters.begin(), cause.parameters.end(),
                               [&](const CauseParameter& own) { return own.name == name; });
        });
    };
    return std::any_of(diagnosis.adjustments.begin(), diagnosis.adjustments.end(), [&](const Adjustment& own) {
        const bool beyond =
            own.parameter.lower > own.believed + own.tolerance || own.parameter.upper < own.believed - own.tolerance;
        return beyond && !isNamed(own.parameter.name);
    });
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

/// Of recordings whose channels say what the model's do.
Diagnosis diagnoseCorrected(const std::vector<Recording>& identification, const std::vector<Recording>& validation,
                            const MountModel& model, const DiagnosisOptions& options) {
    const updating::TestProblem problem(identification, validation, model);
    // The simplest world first: exact numbers and a cause or two. Where that leaves something, nothing is exact.
    updating::ModelUpdate update(problem, model, updating::Numbers::exact, options);
    update.select();
    std::optional<Diagnosis> exact;
    if (!update.asksForMore()) {
        exact = checkVerdict(update.report(), model);
        // What it accuses must satisfy the equations: small errors everywhere find something to accuse.
        const bool answers = exact->causes.empty() || satisfiesEquations(*exact);
        if (exact->verdict != Diagnosis::Verdict::unexplained && (answers || problem.exactlyKnown())) return *exact;
    }
    auto adjusted = diagnoseWithTolerances(problem, model, options);
    if (adjusted) adjusted = checkVerdict(std::move(*adjusted), model);
    if (adjusted && satisfiesEquations(*adjusted)) return std::move(*adjusted);
    if (!exact) exact = checkVerdict(update.report(), model);
    // Where neither satisfies the equations, the prediction decides between two answers of one kind, if one is of more
    // use than the other; an answer that explains stands before one that does not.
    const auto explains = [](const Diagnosis& own) {
        return own.verdict != Diagnosis::Verdict::unexplained && !leavesOneBeyond(own);
    };
    const bool as_good =
        adjusted && (explains(*adjusted) > explains(*exact) ||
                     (explains(*adjusted) == explains(*exact) &&
                      adjusted->error_after.validation < (1 + kWorth) * exact->error_after.validation));
    return std::move(as_good ? *adjusted : *exact);
}

}  // namespace

Diagnosis diagnose(const std::vector<Recording>& identification, const std::vector<Recording>& validation,
                   const MountModel& model, const DiagnosisOptions& options) {
    if (identification.empty()) throw InputError({}, "no recording to diagnose", "at least one CSV file");
    if (model.sensors.empty()) return diagnoseCorrected(identification, validation, model, options);
    const auto correct = [&](std::vector<Recording> recordings) {
        for (Recording& recording : recordings) recording = correctChannels(recording, model.sensors);
        return recordings;
    };
    Diagnosis result = diagnoseCorrected(correct(identification), correct(validation), withoutFaults(model), options);
    addBelievedSensors(model.sensors, identification, result);
    return result;
}

}  // namespace wems::identify
