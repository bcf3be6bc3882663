#include "identify/exact/pass.hpp"

#include "identify/exact/channel_faults.hpp"
#include "identify/exact/whitening.hpp"
#include "identify/motion/swept_frequency.hpp"

namespace wems::identify {

namespace {

// Hz: the band of the tests of the source paper, to which this engine's filters and tapers are set.
constexpr ExcitedBand kBand{5, 50};

/// Accelerations next to complete displacements serve the consistency of channels; the equations take one kind, so
/// that no weighting between two kinds can colour their residual.
Recording withoutAccelerations(const Recording& recording, const MountModel& model) {
    const auto has = [&](const char* side) {
        for (const auto& connection : model.connections)
            for (const char* axis : {"x", "y", "z"})
                if (recording.find(side + connection.name + "." + axis) == nullptr) return false;
        return true;
    };
    if (!has("mobile.") || !has("fixed.")) return recording;
    Recording result = recording;
    result.channels.clear();
    for (const auto& channel : recording.channels) {
        const auto name = parseChannelName(channel.name);
        if (name && (name->part == Part::mobile || name->part == Part::fixed) &&
            name->derivative != Derivative::displacement)
            continue;
        result.channels.push_back(channel);
    }
    return result;
}

}  // namespace

RunGroup::RunGroup(const std::vector<Recording>& recordings, const MountModel& model) {
    for (const auto& recording : recordings) {
        const Recording used = withoutAccelerations(recording, model);
        motions.push_back(estimateMotion(used, model));
        restoreSlowMotion(motions.back(), model);
        swept.push_back(findSweptFrequency(used).hertz);
        free_runs.push_back({nullptr, calcMeasuredRelative(used, motions.back(), model)});
    }
    for (std::size_t i = 0; i < motions.size(); ++i) free_runs[i].motion = &motions[i];
}

OpenLoopProblem RunGroup::makeProblem(const MountModel& model) const {
    std::vector<OpenLoopRun> runs;
    for (std::size_t i = 0; i < motions.size(); ++i)
        runs.push_back(makeOpenLoopRun(motions[i], model, kBand, swept[i]));
    return {std::move(runs), model, kGainScatter};
}

std::vector<Recording> correctFaults(const std::vector<Recording>& recordings, const std::vector<ChannelFault>& faults,
                                     std::size_t kept) {
    std::vector<SensorFault> list;
    for (std::size_t i = 0; i < faults.size(); ++i)
        if (i != kept) list.push_back(faults[i].fault);
    std::vector<Recording> result;
    result.reserve(recordings.size());
    for (const auto& recording : recordings) result.push_back(correctChannels(recording, list));
    return result;
}

Pass::Pass(const std::vector<Recording>& identification, const std::vector<Recording>& judges,
           const std::vector<ChannelFault>& faults, const MountModel& model, const SelectionOptions& options)
    : fit_group(correctFaults(identification, faults, faults.size()), model),
      judge_group(correctFaults(judges, faults, faults.size()), model),
      fit_problem(fit_group.makeProblem(model)),
      judge_problem(judge_group.makeProblem(model)),
      selection(selectCauses(fit_problem, judge_problem, model, options)) {}

}  // namespace wems::identify
