#include "identify/inspect/inspection.hpp"

#include <algorithm>

#include "identify/inspect/abilities.hpp"
#include "identify/inspect/plateaus.hpp"
#include "identify/inspect/slow_defects.hpp"
#include "identify/motion/noise_estimate.hpp"
#include "identify/motion/rigidity.hpp"
#include "identify/motion/uniform_time.hpp"
#include "models/error.hpp"
#include "models/recording/connection_checks.hpp"

namespace wems::identify {
namespace {

constexpr std::size_t least_samples = 64;

void inspectWithModel(const Recording& recording, const MountModel& model, Inspection& inspection) {
    for (Finding& finding : checkAgainstModel(recording, model)) inspection.findings.push_back(std::move(finding));
    try {
        for (const ChannelSuspect& suspect : checkRigidity(recording, model).suspects) {
            inspection.notes.push_back(suspect.channel + " does not move as the rigid part does: " + suspect.fault +
                                       (suspect.exchanged_with.empty() ? "" : " with " + suspect.exchanged_with) +
                                       "; `identify rigidity` says more");
        }
    } catch (const InputError& error) {
        inspection.notes.push_back("rigidity is not checked: " + error.problem());
    }
}

}  // namespace

std::vector<Finding> findDefects(const Recording& recording, const SweptFrequency& swept) {
    std::vector<Finding> findings = recording.findings;
    if (recording.sampleCount() < least_samples) return findings;
    const double interval = recording.sampleInterval();
    for (const Channel& channel : recording.channels) {
        const Eigen::Map<const Eigen::VectorXd> signal(channel.values.data(),
                                                       static_cast<Eigen::Index>(channel.values.size()));
        const double noise = estimateNoiseFromSignal(signal);
        const bool clipped = std::any_of(findings.begin(), findings.end(), [&](const Finding& finding) {
            return finding.kind == FindingKind::clipped && finding.channel == channel.name;
        });
        for (Finding& finding : findPlateaus(channel, recording.time, noise, recording.first_row)) {
            // One limit, one finding.
            if (finding.kind == FindingKind::saturated && clipped) continue;
            findings.push_back(std::move(finding));
        }
        const bool limited = std::any_of(findings.begin(), findings.end(), [&](const Finding& finding) {
            return finding.channel == channel.name &&
                   (finding.kind == FindingKind::clipped || finding.kind == FindingKind::saturated);
        });
        for (Finding& finding : findSlowDefects(channel, interval, noise, swept, recording.time, recording.first_row)) {
            // What is cut off on one side shifts the mean: one fault, one finding.
            if (finding.kind == FindingKind::offset && limited) continue;
            findings.push_back(std::move(finding));
        }
    }
    return findings;
}

Inspection inspect(const Recording& recording, const MountModel* model) {
    Inspection inspection;
    const double interval = recording.sampleInterval();
    inspection.rate = interval > 0 ? 1 / interval : 0;
    inspection.duration = recording.time.empty() ? 0 : recording.time.back() - recording.time.front();
    Recording uniform = recording;
    if (recording.sampleCount() >= least_samples) uniform = makeUniform(recording, inspection.notes);
    for (const Channel& channel : uniform.channels)
        inspection.channels.push_back(calcStatistics(channel, uniform.sampleInterval()));
    inspection.swept = findSweptFrequency(uniform);
    inspection.orders = trackOrders(uniform, inspection.swept);
    inspection.findings = findDefects(recording, inspection.swept);
    if (model != nullptr) inspectWithModel(recording, *model, inspection);
    std::stable_sort(inspection.findings.begin(), inspection.findings.end(),
                     [](const Finding& a, const Finding& b) { return a.row < b.row; });
    inspection.abilities = describeAbilities(recording, model);
    return inspection;
}

}  // namespace wems::identify
