#include "identify/fit/fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "identify/fit/open_groups.hpp"
#include "identify/fit/slow_offset.hpp"
#include "identify/fit/stored_equations.hpp"
#include "identify/motion/parallel.hpp"
#include "models/common/error.hpp"

namespace wems::identify {

namespace {

std::vector<RunEquations> makeAllEquations(const std::vector<RunMotion>& runs, const MountModel& model,
                                           const FitOptions& options) {
    std::vector<std::optional<RunEquations>> pieces(runs.size());
    runParallel(runs.size(), [&](std::size_t r) { pieces[r] = makeRunEquations(runs[r], model, options); });
    std::vector<RunEquations> equations;
    for (auto& piece : pieces) equations.push_back(std::move(*piece));
    return equations;
}

/// Takes out stops whose stiffness is not significantly different from zero, or is next to nothing beside the
/// elastomer's (a bend of the elastomer's law, or of what an integrated motion leaves): they were not reached.
ParameterUncertainty removeSpuriousStops(Solver& solver) {
    constexpr double least = 4;           // standard errors
    constexpr double least_share = 0.02;  // of the elastomer's stiffness
    while (true) {
        const LinearSystem system = solver.linearise();
        ParameterUncertainty uncertainty(solver, system);
        double weakest = least;
        int weakest_parameter = -1;
        for (std::size_t j = 0; j < system.parameters.size(); ++j) {
            const Parameter& parameter = solver.parameters()[system.parameters[j]];
            if (parameter.kind != ParameterKind::stop_stiffness) continue;
            const Eigen::Index k = j;
            const double error =
                system.scale(k) * uncertainty.calcStandardError(Eigen::VectorXd::Unit(system.scale.size(), k));
            const double stiffness = std::abs(getParameter(solver.model(), parameter.name));
            const Connection& connection = solver.model().connections[parameter.connection];
            const double elastomer = connection.axis.at(parameter.axis).stiffness;
            double ratio = stiffness / error;
            if (stiffness < least_share * elastomer) ratio = std::min(ratio, stiffness / (least_share * elastomer));
            if (ratio < weakest) {
                weakest = ratio;
                weakest_parameter = system.parameters[j];
            }
        }
        if (weakest_parameter < 0) return uncertainty;
        solver.removeStop(solver.parameters()[weakest_parameter]);
    }
}

/// The slow motion of all runs that lack it, for one law. Returns the largest RMS change of a run's relative
/// displacements, m. @throws InputError where it grows without bound, as with accelerations in a wrong unit
double updateSlowMotion(std::vector<RunMotion>& runs, const MountModel& law) {
    constexpr int newton_steps = 3;
    double change = 0;
    for (RunMotion& run : runs) {
        if (!lacksSlowMotion(run)) continue;
        change = std::max(change, updateSlowOffset(run, law));
        for (int step = 1; step < newton_steps; ++step) updateSlowOffset(run, law);
        if (!run.mobile.p.allFinite() || !run.mobile.theta.allFinite())
            throw InputError({run.file, 0, ""},
                             "no slow motion lets the mount's force balance what the accelerations demand",
                             "channels in their right units, and the mass and stiffness of this device");
    }
    return change;
}

/// `model` moved on by half of its change since `before`, which shortens the way to the fixed point.
MountModel extrapolate(const MountModel& model, const MountModel& before, const std::vector<Parameter>& parameters) {
    constexpr double momentum = 0.5, largest = 0.2;  // of the change; of the value
    MountModel ahead = model;
    for (const Parameter& parameter : parameters) {
        const double value = getParameter(model, parameter.name);
        const double step = momentum * (value - getParameter(before, parameter.name));
        if (std::abs(step) < largest * std::abs(value)) setParameter(ahead, parameter.name, value + step);
    }
    return ahead;
}

/// Runs of accelerations alone with their slow motion: law and motion are improved in turn until neither changes.
std::vector<RunMotion> recoverSlowMotion(std::vector<RunMotion> runs, const MountModel& model,
                                         const FitOptions& options, FitResult& result) {
    constexpr int most_passes = 12;
    constexpr double settled = 2e-7;  // m RMS
    const std::vector<Parameter> parameters = makeParameters(model, options.free_body);
    for (RunMotion& run : runs)
        if (lacksSlowMotion(run)) cutRinging(run);
    std::optional<MountModel> before;
    double change = 0;
    int pass = 0;
    do {
        NormalEquations normal_equations(makeAllEquations(runs, model, options));
        Solver solver(runs, normal_equations, parameters, model);
        solver.run();
        change = updateSlowMotion(runs, before ? extrapolate(solver.model(), *before, parameters) : solver.model());
        before = solver.model();
    } while (++pass < most_passes && change > settled);
    std::array<char, 160> text{};
    std::snprintf(
        text.data(), text.size(),
        "accelerations alone: slow motion from the balance of the mount's force, %d passes, last change %.2g m", pass,
        change);
    result.notes.emplace_back(text.data());
    return runs;
}

}  // namespace

FitResult fitMount(const std::vector<RunMotion>& measured, const MountModel& model, const FitOptions& options) {
    if (measured.empty()) throw InputError({}, "no run to fit");
    FitResult result;
    Stopwatch watch(result.timing);
    std::vector<RunMotion> recovered;
    if (std::any_of(measured.begin(), measured.end(), lacksSlowMotion)) {
        recovered = recoverSlowMotion(measured, model, options, result);
        watch.lap("slow motion");
    }
    const std::vector<RunMotion>& runs = recovered.empty() ? measured : recovered;
    std::vector<RunEquations> equations = makeAllEquations(runs, model, options);
    watch.lap("equations of motion");
    FitResult solved = solveEquations(runs, std::move(equations), model, options);
    solved.notes.insert(solved.notes.begin(), result.notes.begin(), result.notes.end());
    solved.timing.insert(solved.timing.begin(), result.timing.begin(), result.timing.end());
    return solved;
}

FitResult solveEquations(const std::vector<RunMotion>& runs, std::vector<RunEquations> equations,
                         const MountModel& model, const FitOptions& options) {
    FitResult result;
    Stopwatch watch(result.timing);
    NormalEquations normal_equations(std::move(equations));
    Solver solver(runs, normal_equations, makeParameters(model, options.free_body), model);
    solver.run();
    watch.lap("least squares");
    const ParameterUncertainty uncertainty = removeSpuriousStops(solver);
    watch.lap("intervals");
    fillResult(solver, solver.linearise(), uncertainty, options, result);
    watch.lap("what is not known");
    return result;
}

namespace {

std::string format(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.4g", value);
    return text.data();
}

/// The sampled equations themselves are no better than this part of a value (equation_of_motion.hpp), however little
/// noise there is.
constexpr double kDiscretisation = 2e-4;

/// Statistical covariance plus what an error of the regressors may do to directions that are barely separated. What is
/// not known at all is still known to be within a few times its scale.
Eigen::MatrixXd addGeometryError(const LinearSystem& system, const Eigen::MatrixXd& covariance, double error) {
    constexpr double largest = 2;
    Eigen::MatrixXd total = covariance;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> separation(system.inverse);
    for (Eigen::Index d = 0; d < total.rows(); ++d) {
        const Eigen::VectorXd direction = separation.eigenvectors().col(d);
        const double wrench = error * direction.cwiseProduct(system.column_norm).norm();  // that the error stands for
        total += wrench * wrench * std::max(0.0, separation.eigenvalues()(d)) * direction * direction.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(total);
    const Eigen::VectorXd variances = eigen.eigenvalues().cwiseMin(largest * largest).cwiseMax(0.0);
    return eigen.eigenvectors() * variances.asDiagonal() * eigen.eigenvectors().transpose();
}

JointEstimate makeEstimate(const Solver& solver, const std::vector<Parameter>& parameters, const Eigen::VectorXd& scale,
                           const Eigen::MatrixXd& covariance) {
    JointEstimate estimate;
    estimate.values.resize(scale.size());
    for (std::size_t j = 0; j < parameters.size(); ++j) {
        const Eigen::Index row = j;
        estimate.names.push_back(parameters[j].name);
        estimate.values[row] = getParameter(solver.model(), parameters[j].name);
    }
    estimate.covariance = scale.asDiagonal() * covariance * scale.asDiagonal();
    return estimate;
}

void reportUnreachedStops(Solver& solver, FitResult& result) {
    for (const Parameter& parameter : solver.parameters()) {
        if (parameter.kind != ParameterKind::clearance) continue;
        const StopTerm term{parameter.connection, parameter.axis, parameter.stop};
        const auto& reached = solver.equations().stops();
        if (std::any_of(reached.begin(), reached.end(), [&](const StopTerm& s) {
                return s.historyIndex() == term.historyIndex() && s.stop == term.stop;
            }))
            continue;
        const double noticed = solver.findNoticedClearance(term);
        result.unreached[parameter.name] = noticed;
        const std::string stop = parameter.name.substr(0, parameter.name.rfind('.'));
        UnidentifiedGroup entry;
        entry.names = {parameter.name, stop + ".stiffness"};
        entry.unit = "";
        entry.reason = noticed > 0 ? "not reached: clearance > " + format(noticed) + " m" : "not reached";
        const double beyond = std::max(solver.calcReach(term), stopOf(solver.base(), term).clearance);
        entry.separate_by = "a run in which " + stop + " is pushed beyond " + format(beyond) + " m";
        result.not_identifiable.push_back(std::move(entry));
    }
}

}  // namespace

void fillResult(Solver& solver, const LinearSystem& system, const ParameterUncertainty& uncertainty,
                const FitOptions& options, FitResult& result) {
    std::vector<Parameter> taking_part;
    for (const int p : system.parameters) taking_part.push_back(solver.parameters()[p]);
    const Eigen::MatrixXd covariance = addGeometryError(system, uncertainty.makeCovariance(), options.geometry_error);
    result.estimate = makeEstimate(solver, taking_part, system.scale, covariance);
    result.directions = findDirections(taking_part, system.information, covariance);
    const Identifiability identifiability =
        findIdentifiable(solver.model(), taking_part, system.scale, covariance,
                         [&](const Eigen::VectorXd& combination) { return uncertainty.calcHalfWidth(combination); });
    fillParameters(
        {taking_part, system.scale, solver.base(), solver.model(), kDiscretisation,
         [&](const Eigen::VectorXd& combination) { return uncertainty.calcHalfWidth(combination); }},
        identifiability, [&](const Eigen::VectorXd& combination) { return uncertainty.calcStandardError(combination); },
        result);
    reportUnreachedStops(solver, result);
    result.remainders = calcRemainders(solver);
    result.residual_fraction = calcUnexplainedFraction(result.remainders, solver.model());
    const double expected = solver.calcNoiseSquares() + uncertainty.calibrationSquares();
    result.residual_over_noise = expected > 0 ? std::sqrt(solver.calcResidualSquares() / expected) : 0.0;
    if (const auto note = describeMissingTerms(result)) result.notes.push_back(*note);
}

std::optional<std::string> describeMissingTerms(const FitResult& result) {
    constexpr double notable = 2, least_fraction = 5e-3;
    if (result.residual_over_noise < notable || result.residual_fraction < least_fraction) return std::nullopt;
    return "what is left unexplained is " + format(result.residual_over_noise) +
           " times what the channels' noise leaves: the mount does something that this model does not have "
           "(identify diagnose looks for it), and the intervals hold only as far as the model does";
}

void fillParameters(const SolvedParameters& solved, const Identifiability& identifiability,
                    const std::function<double(const Eigen::VectorXd&)>& calcStandardError, FitResult& result) {
    result.model = solved.believed;
    for (std::size_t j = 0; j < solved.parameters.size(); ++j) {
        if (!identifiability.known[j]) continue;
        const Eigen::Index k = j;
        const Eigen::VectorXd combination = solved.scale(k) * Eigen::VectorXd::Unit(solved.scale.size(), k);
        FittedParameter fitted{solved.parameters[j].name, solved.parameters[j].unit, 0, 0, 0, {}};
        fitted.model_value = getParameter(solved.believed, fitted.name);
        fitted.value = getParameter(solved.fitted, fitted.name);
        fitted.standard_error = calcStandardError(combination);
        fitted.interval95 = makeInterval(
            fitted.value, std::max(solved.calcHalfWidth(combination), solved.least_error * std::abs(fitted.value)));
        setParameter(result.model, fitted.name, fitted.value);
        result.parameters.push_back(std::move(fitted));
    }
    addOpenGroups(solved, identifiability, result);
}

}  // namespace wems::identify
