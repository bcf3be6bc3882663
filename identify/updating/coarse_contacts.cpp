#include "identify/updating/coarse_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "identify/fit/open_groups.hpp"
#include "identify/problem/open_loop_run.hpp"
#include "identify/problem/run_filter.hpp"
#include "identify/updating/settling.hpp"
#include "identify/updating/test_problem.hpp"
#include "identify/verdict/diagnosis.hpp"
#include "models/parameter_access.hpp"

namespace wems::identify::updating {
namespace {

constexpr double kFree = 10;    // relative tolerance of a law's number: five times itself as deviation
constexpr int kMostSteps = 16;  // of Gauss and Newton, for time: as many as sets of causes have

/// Laws free, all else exactly known.
MountModel freeLaws(MountModel model) {
    Tolerances exact;
    for (std::size_t i = 0; i < kToleranceKeys.size(); ++i) exact.set(static_cast<ToleranceOf>(i), 0.0);
    for (const ToleranceOf law :
         {ToleranceOf::stiffness, ToleranceOf::damping, ToleranceOf::clearance, ToleranceOf::stop_stiffness})
        exact.set(law, kFree);
    model.tolerances = exact;
    model.body.tolerances = {};
    for (Connection& connection : model.connections) {
        connection.tolerances = {};
        connection.axis_tolerances = {};
    }
    for (BracketMode& mode : model.bracket) mode.tolerances = {};
    for (SensorFault& sensor : model.sensors) sensor.tolerances = {};
    return model;
}

/// Drives of the bracket left out: a fit asks nothing of the bracket.
Recording withoutDrives(Recording recording, const MountModel& model) {
    const bool on_mobile = model.load_point && model.load_point->part == Part::mobile;
    const bool has_fixed =
        std::any_of(recording.channels.begin(), recording.channels.end(), [](const Channel& channel) {
            const auto name = parseChannelName(channel.name);
            return name && name->part == Part::fixed;
        });
    const auto drives = [&](const Channel& channel) {
        if (channel.name.rfind("load.", 0) == 0) return !on_mobile;
        return has_fixed && channel.name.rfind("base.", 0) == 0;
    };
    recording.channels.erase(std::remove_if(recording.channels.begin(), recording.channels.end(), drives),
                             recording.channels.end());
    return recording;
}

/// In the parameters' own scales. @param all of the problem's table
Eigen::MatrixXd calcScaledCovariance(const TestProblem& problem, const Eigen::MatrixXd& all,
                                     const std::vector<Parameter>& parameters, const Eigen::VectorXd& scale) {
    std::vector<Eigen::Index> rows;
    for (const Parameter& parameter : parameters) {
        const UnknownTable& table = problem.table();
        const auto found =
            std::find_if(table.begin(), table.end(), [&](const Unknown& row) { return row.name == parameter.name; });
        if (found == table.end()) return {};
        rows.push_back(found - table.begin());
    }
    const Eigen::MatrixXd own = all(rows, rows);
    return scale.cwiseInverse().asDiagonal() * own * scale.cwiseInverse().asDiagonal();
}

}  // namespace

bool hasCoarseContacts(const FitResult& fit, const std::vector<RunMotion>& runs) {
    const bool reached = std::any_of(fit.estimate.names.begin(), fit.estimate.names.end(), [](const std::string& name) {
        return name.find(".clearance") != std::string::npos;
    });
    const double contact = calcContactFrequency(fit.model);
    const auto isAlone = [](const PartMotion& part) {
        return part.displacement_measured && !part.acceleration_measured;
    };
    return reached &&
           std::all_of(runs.begin(), runs.end(),
                       [&](const RunMotion& run) { return isAlone(run.mobile) && isAlone(run.fixed); }) &&
           std::any_of(runs.begin(), runs.end(),
                       [&](const RunMotion& run) { return !RunFilter::resolves(run.interval, contact); });
}

std::optional<FitResult> refineCoarseContacts(const FitResult& fit, const std::vector<Recording>& recordings,
                                              const MountModel& believed) {
    std::vector<Recording> runs;
    for (const Recording& recording : recordings) runs.push_back(withoutDrives(recording, fit.model));
    const TestProblem problem(runs, {}, freeLaws(fit.model), Numbers::within_tolerances);
    const Settler settler(problem);
    SetState state;
    state.point = problem.believedPoint();
    state.view = problem.view(state.point, state.set);
    const auto misfitOf = [&] {
        return calcMisfits(sumOf(state.view, true), problem.estimateOf(state.point))[indexOf(Block::mount)];
    };
    const double before = misfitOf();
    settler.settle(state, kMostSteps, true);
    const double after = misfitOf();
    if (!(after <= before)) return std::nullopt;
    std::vector<Parameter> parameters;
    for (const Parameter& parameter : makeParameters(believed, {}))
        if (std::find(fit.estimate.names.begin(), fit.estimate.names.end(), parameter.name) != fit.estimate.names.end())
            parameters.push_back(parameter);
    const Eigen::Index count = parameters.size();
    if (count != fit.estimate.values.size()) return std::nullopt;
    Eigen::VectorXd scale(count);
    for (Eigen::Index j = 0; j < count; ++j) scale[j] = calcScale(believed, parameters[static_cast<std::size_t>(j)]);
    const Eigen::MatrixXd covariance = calcScaledCovariance(
        problem, makeEvidence(problem, state.view, state.set, state.scales, true).calcPosterior(state.set).covariance,
        parameters, scale);
    if (covariance.rows() != count || !covariance.allFinite()) return std::nullopt;
    const auto calcError = [&](const Eigen::VectorXd& combination) {
        return std::sqrt(std::max(0.0, combination.dot(covariance * combination)));
    };
    const auto calcHalfWidth = [&](const Eigen::VectorXd& combination) { return kTwoSided95 * calcError(combination); };

    FitResult result = fit;
    result.parameters.clear();
    result.not_identifiable.clear();
    const MountModel& solved = state.point.state.model;
    const Eigen::MatrixXd apart =
        scale.cwiseInverse().asDiagonal() * fit.estimate.covariance * scale.cwiseInverse().asDiagonal();
    const SolvedParameters values{parameters, scale, believed, solved, 0, calcHalfWidth};
    fillParameters(values, findIdentifiable(solved, parameters, scale, apart, calcHalfWidth), calcError, result);
    for (const UnidentifiedGroup& group : fit.not_identifiable)
        if (fit.unreached.count(group.names.front()) > 0) result.not_identifiable.push_back(group);
    for (Eigen::Index j = 0; j < count; ++j)
        result.estimate.values[j] = getParameter(solved, parameters[static_cast<std::size_t>(j)].name);
    result.estimate.covariance = scale.asDiagonal() * covariance * scale.asDiagonal();
    if (const auto note = describeMissingTerms(fit))
        result.notes.erase(std::remove(result.notes.begin(), result.notes.end(), *note), result.notes.end());
    result.residual_over_noise = std::sqrt(after);
    if (const auto note = describeMissingTerms(result)) result.notes.push_back(*note);
    char text[200];
    std::snprintf(text, sizeof text,
                  "contacts between few samples: numbers from the equations with the motion between them, which leave "
                  "%.3g times the noise (%.3g at those of the samples alone)",
                  std::sqrt(after), std::sqrt(before));
    result.notes.emplace_back(text);
    return result;
}

}  // namespace wems::identify::updating
