#include "identify/inspect/quality.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "identify/inspect/derivative_check.hpp"
#include "identify/motion/uniform_time.hpp"
#include "models/error.hpp"
#include "models/format_number.hpp"

namespace wems::identify {
namespace {

constexpr double kContradiction = 0.05, kStrongContradiction = 0.15;  // of the signals

bool spoilsSignal(FindingKind kind) {
    switch (kind) {
        case FindingKind::gap:
        case FindingKind::missing_value:
        case FindingKind::clipped:
        case FindingKind::saturated:
        case FindingKind::drop_out:
        case FindingKind::constant:
        case FindingKind::backward_time:
            return true;
        default:
            return false;
    }
}

void lowerTo(QualityVerdict& verdict, Quality quality, const std::string& reason) {
    verdict.quality = std::max(verdict.quality, quality);
    verdict.reasons.push_back(reason);
}

void judgePart(const PartConsistency& part, QualityVerdict& verdict) {
    if (part.redundancy == 0) return;
    verdict.checked = true;
    verdict.contradiction = std::max(verdict.contradiction, part.before);
    for (const MeasurementFault& fault : part.faults) {
        std::string reason = describe(fault);
        for (const std::string& other : fault.alternatives) reason += ", or " + other;
        lowerTo(verdict, fault.kind == MeasurementFault::Kind::gain ? Quality::doubtful : Quality::unusable, reason);
        verdict.faults.push_back(fault);
    }
    if (!(part.after > kContradiction)) return;
    lowerTo(verdict, part.after > kStrongContradiction ? Quality::unusable : Quality::doubtful,
            std::string("channels of the ") + (part.part == Part::mobile ? "mobile" : "fixed") +
                " part contradict a rigid motion by " + formatNumber(100 * part.after, 2) + " %" +
                (part.solved ? "" : ", which no few faults explain"));
}

/// One reason for all channels of a kind.
void addFindings(const std::vector<Finding>& findings, QualityVerdict& verdict) {
    std::map<FindingKind, std::vector<std::string>> kinds;
    for (const Finding& finding : findings)
        if (spoilsSignal(finding.kind)) kinds[finding.kind].push_back(finding.channel);
    for (const auto& [kind, channels] : kinds)
        lowerTo(verdict, Quality::doubtful,
                std::string(kindName(kind)) + " in " + channels.front() +
                    (channels.size() > 1 ? " and " + std::to_string(channels.size() - 1) + " more" : ""));
}

}  // namespace

const char* qualityName(Quality quality) {
    static constexpr const char* names[] = {"good", "doubtful", "unusable"};
    return names[static_cast<std::size_t>(quality)];
}

QualityVerdict judgeQuality(const Recording& recording, const MountModel* model, const std::vector<Finding>& findings) {
    QualityVerdict verdict;
    if (model != nullptr) {
        try {
            std::vector<std::string> notes;
            for (const PartConsistency& part : findMeasurementFaults(makeUniform(recording, notes), *model))
                judgePart(part, verdict);
        } catch (const InputError& error) {
            lowerTo(verdict, Quality::doubtful, "the channels cannot be compared: " + error.problem());
        }
    }
    // With few channels a factor shows beside the displacement alone, without a culprit.
    if (verdict.faults.empty())
        for (const std::string& sentence : findContradictions(recording)) lowerTo(verdict, Quality::unusable, sentence);
    addFindings(findings, verdict);
    return verdict;
}

QualityVerdict judgeFindings(const std::vector<Finding>& findings) {
    QualityVerdict verdict;
    addFindings(findings, verdict);
    return verdict;
}

std::string formatVerdict(const QualityVerdict& verdict) {
    std::string text = std::string("Quality: ") + qualityName(verdict.quality);
    for (std::size_t i = 0; i < verdict.reasons.size(); ++i) text += (i == 0 ? ": " : "; ") + verdict.reasons[i];
    return text + ".";
}

}  // namespace wems::identify
