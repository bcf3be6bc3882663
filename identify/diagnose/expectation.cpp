#include "identify/diagnose/expectation.hpp"

#include <limits>

#include "identify/diagnose/free_error.hpp"
#include "identify/diagnose/pass.hpp"
#include "identify/diagnose/simulated_recording.hpp"
#include "identify/forward/forward_model.hpp"

namespace wems::identify {

Expectation calcExpectation(const std::vector<RunMotion>& runs, const MountModel& base, const MountModel& model) {
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    try {
        std::vector<Recording> recordings;
        for (const auto& run : runs) recordings.push_back(simulateRecording(run, model, {1, kGainScatter}));
        const RunGroup group(recordings, base);
        const OpenLoopProblem problem = group.makeProblem(model);
        return {calcFreeError(group.free_runs, model).error, problem.calcMisfit(model)};
    } catch (const SimulationDiverged&) {
        return {kInfinite, kInfinite};
    }
}

}  // namespace wems::identify
