#include "identify/diagnose/diagnose.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "identify/updating/settling.hpp"
#include "identify/updating/update.hpp"
#include "models/common/error.hpp"

namespace wems::identify {

namespace {

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
        return updating::updateModel(identification, validation, model, updating::Numbers::within_tolerances, options);
    } catch (const InputError&) {  // said by the step with exact numbers too, in the terms of its own needs
        return std::nullopt;
    }
}

/// What every sensor has a little of, AC coupling above all, passes for faults of some where sensors are exact.
bool accusesSensors(const Diagnosis& answer) {
    return std::any_of(answer.causes.begin(), answer.causes.end(),
                       [](const Cause& cause) { return cause.cause.rfind("sensor_", 0) == 0; });
}

/// Whether all equations leave noise alone, whatever a sensitive prediction makes of what is not known.
bool isSatisfied(const Diagnosis& adjusted) {
    const std::vector<double>& misfit = adjusted.decisions.back().misfit;
    return std::all_of(misfit.begin(), misfit.end(), [](double own) { return own < updating::kSatisfied; });
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
    Diagnosis exact = checkVerdict(
        updating::updateModel(identification, validation, model, updating::Numbers::exact, options), model);
    // What it accuses must satisfy the equations and be no sensor: small errors everywhere find something to accuse.
    const bool answers = exact.causes.empty() || (isSatisfied(exact) && !accusesSensors(exact));
    if (exact.verdict != Diagnosis::Verdict::unexplained && (answers || isExactlyKnown(model))) return exact;
    auto adjusted = diagnoseWithTolerances(identification, validation, model, options);
    if (adjusted) adjusted = checkVerdict(std::move(*adjusted), model);
    // Of two answers that leave something, the one that satisfies the equations, else the one that predicts better.
    if (!adjusted || (adjusted->verdict == Diagnosis::Verdict::unexplained && !isSatisfied(*adjusted) &&
                      exact.error_after.validation <= adjusted->error_after.validation))
        return exact;
    return std::move(*adjusted);
}

}  // namespace wems::identify
