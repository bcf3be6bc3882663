#include "identify/diagnose/fit_bias.hpp"

#include "identify/diagnose/parameter_fit.hpp"
#include "identify/diagnose/pass.hpp"
#include "identify/diagnose/simulated_recording.hpp"
#include "identify/forward/forward_model.hpp"

namespace wems::identify {
namespace {

constexpr int kSlowPasses = 3;  // where the slow motion follows the model

Eigen::VectorXd fitAgain(const std::vector<Recording>& recordings, const MountModel& base, const MountModel& model,
                         const std::vector<Knob>& knobs) {
    const RunGroup group(recordings, base);
    OpenLoopProblem problem = group.makeProblem(model);
    ParameterFit fit = fitParameters(problem, model, knobs);
    for (int pass = 1; pass < kSlowPasses && problem.hasSlowBalance(); ++pass) {
        problem.rewhiten(fit.model);
        fit = fitParameters(problem, fit.model, knobs);
    }
    return Eigen::Map<const Eigen::VectorXd>(fit.values.data(), fit.values.size());
}

}  // namespace

Eigen::VectorXd calcFitBias(const std::vector<RunMotion>& runs, const MountModel& base, const MountModel& model,
                            const std::vector<Knob>& knobs) {
    const Eigen::Index count = knobs.size();
    Eigen::VectorXd given(count), mean = Eigen::VectorXd::Zero(count);
    for (Eigen::Index i = 0; i < count; ++i) given[i] = knobs[i].get(model);
    try {
        for (const double sign : {1.0, -1.0}) {
            std::vector<Recording> recordings;
            for (const auto& run : runs) recordings.push_back(simulateRecording(run, model, {sign, 0}));
            mean += 0.5 * fitAgain(recordings, base, model, knobs);
        }
    } catch (const SimulationDiverged&) {
        return Eigen::VectorXd::Zero(count);
    }
    return mean - given;
}

}  // namespace wems::identify
