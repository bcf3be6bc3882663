#include "identify/fit/fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "identify/fit/fit_result.hpp"
#include "identify/fit/run_equations.hpp"
#include "identify/fit/slow_offset.hpp"
#include "identify/fit/stopwatch.hpp"
#include "identify/motion/parallel.hpp"
#include "models/error.hpp"

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

}  // namespace wems::identify
