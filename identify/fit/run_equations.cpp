#include "identify/fit/run_equations.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace

RunEquations makeRunEquations(const RunMotion& run, const MountModel& model, const FitOptions& options) {
    const TestFunction test_function(chooseKnotSamples(run, options), run.interval);
    if (test_function.outputCount(static_cast<int>(run.time.size())) < 50)
        throw InputError({run.file, 0, ""}, "too short for a fit: " + std::to_string(run.time.size()) + " samples",
                         "at least " + std::to_string(50 * test_function.stride() + 2 * test_function.half()));
    return makeEquations(run, model, test_function, !options.free_body.empty());
}

}  // namespace wems::identify
