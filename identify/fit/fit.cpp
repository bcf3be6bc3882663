#include "identify/fit/fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "identify/fit/fit_report.hpp"
#include "identify/fit/stopwatch.hpp"
#include "models/error.hpp"

namespace wems::identify {
namespace {

/// Width of the test function: displacements alone need more smoothing since their second derivative is taken.
int chooseKnotSamples(const RunMotion& run, const FitOptions& options) {
    constexpr double with_accelerations = 0.5e-3, without = 2.5e-3;  // s
    const double time = options.knot_time > 0              ? options.knot_time
                        : run.mobile.acceleration_measured ? with_accelerations
                                                           : without;
    return std::max(1, static_cast<int>(std::lround(time / run.interval)));
}

RunEquations makeRunEquations(const RunMotion& run, const MountModel& model, const FitOptions& options) {
    const TestFunction test_function(chooseKnotSamples(run, options), run.interval);
    if (test_function.outputCount(static_cast<int>(run.time.size())) < 50)
        throw InputError({run.file, 0, ""}, "too short for a fit: " + std::to_string(run.time.size()) + " samples",
                         "at least " + std::to_string(50 * test_function.stride() + 2 * test_function.half()));
    return makeEquations(run, model, test_function, !options.free_body.empty());
}

/// Takes out stops whose stiffness is not significantly different from zero: they were not reached.
ParameterUncertainty removeSpuriousStops(Solver& solver) {
    constexpr double least = 4;  // standard errors
    while (true) {
        const LinearSystem system = solver.linearise();
        const ParameterUncertainty uncertainty(solver, system);
        double weakest = least;
        int weakest_parameter = -1;
        for (std::size_t j = 0; j < system.parameters.size(); ++j) {
            const Parameter& parameter = solver.parameters()[static_cast<std::size_t>(system.parameters[j])];
            if (parameter.kind != ParameterKind::stop_stiffness) continue;
            const auto k = static_cast<Eigen::Index>(j);
            const double error =
                system.scale(k) * uncertainty.calcStandardError(Eigen::VectorXd::Unit(system.scale.size(), k));
            const double ratio = std::abs(getParameter(solver.model(), parameter.name)) / error;
            if (ratio < weakest) {
                weakest = ratio;
                weakest_parameter = system.parameters[j];
            }
        }
        if (weakest_parameter < 0) return uncertainty;
        solver.removeStop(solver.parameters()[static_cast<std::size_t>(weakest_parameter)]);
    }
}

}  // namespace

FitResult fitMount(const std::vector<RunMotion>& runs, const MountModel& model, const FitOptions& options) {
    if (runs.empty()) throw InputError({}, "no run to fit");
    FitResult result;
    Stopwatch watch(result.timing);
    const std::vector<Parameter> parameters = makeParameters(model, options.free_body);
    std::vector<RunEquations> equations;
    for (const RunMotion& run : runs) equations.push_back(makeRunEquations(run, model, options));
    watch.lap("equations of motion");
    NormalEquations normal_equations(std::move(equations));
    Solver solver(runs, normal_equations, parameters, model);
    solver.run();
    watch.lap("least squares");
    const ParameterUncertainty uncertainty = removeSpuriousStops(solver);
    watch.lap("intervals");
    reportFit(solver, solver.linearise(), uncertainty, options, result);
    watch.lap("what is not known");
    return result;
}

}  // namespace wems::identify
