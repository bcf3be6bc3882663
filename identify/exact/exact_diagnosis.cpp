#include "identify/exact/exact_diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "identify/exact/acceleration_faults.hpp"
#include "identify/exact/judge.hpp"
#include "identify/exact/leftover.hpp"
#include "identify/exact/pass.hpp"

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

}  // namespace

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

}  // namespace wems::identify
