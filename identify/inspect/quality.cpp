#include "identify/inspect/quality.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "identify/inspect/channel_cells.hpp"
#include "identify/motion/uniform_sampling.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/common/units.hpp"

namespace wems::identify {

namespace {

using Complex = std::complex<double>;

constexpr std::size_t kLongestSegment = 2048, kShortestSegment = 64;
constexpr std::size_t kLeastSegments = 7;  // half overlapping; fewer show coherence by chance
constexpr double kCoherent = 0.9;
constexpr std::size_t kLeastBins = 5;
constexpr std::size_t kFirstBin = 4;  // the window's own spectrum spoils those below
constexpr double kLargestRatio = 1.5;

std::optional<double> calcRatio(const Channel& displacement, const Channel& acceleration, double interval) {
    std::size_t length = kLongestSegment;
    while (length > kShortestSegment && displacement.values.size() < (kLeastSegments + 1) * length / 2) length /= 2;
    const auto q = transformSegments(displacement.values, length), a = transformSegments(acceleration.values, length);
    if (q.size() < kLeastSegments) return std::nullopt;
    // Of each coherent bin the ratio, and what both signals hold there: beyond their band, where the window lets the
    // strong bins of one signal through, the ratio says nothing.
    std::vector<std::pair<double, double>> ratios;
    double all = 0;
    for (std::size_t bin = kFirstBin; bin < length / 2; ++bin) {
        const double omega = kTwoPi * static_cast<double>(bin) / (static_cast<double>(length) * interval);
        double expected = 0, measured = 0;
        Complex common = 0;
        for (std::size_t s = 0; s < q.size(); ++s) {
            const Complex derivative = -omega * omega * q[s][bin];
            expected += std::norm(derivative);
            measured += std::norm(a[s][bin]);
            common += a[s][bin] * std::conj(derivative);
        }
        if (!(expected > 0) || !(std::norm(common) > kCoherent * expected * measured)) continue;
        ratios.emplace_back(common.real() / expected, std::abs(common) / (omega * omega));
        all += ratios.back().second;
    }
    if (ratios.size() < kLeastBins) return std::nullopt;
    std::sort(ratios.begin(), ratios.end());
    double below = 0;
    for (const auto& [ratio, weight] : ratios)
        if ((below += weight) >= 0.5 * all) return ratio;
    return std::nullopt;
}

/// What makes such a ratio, as a mistake.
struct Mistake {
    double ratio;
    const char* text;
};

/// nullptr where none is known.
const Mistake* explain(double ratio) {
    constexpr double g = 9.80665;
    static constexpr Mistake mistakes[] = {
        {1 / g, "accelerations in g labelled m/s^2"},
        {g, "accelerations in m/s^2 labelled g"},
        {1e3, "displacements in m labelled mm, or accelerations in mm/s^2 labelled m/s^2"},
        {1e-3, "displacements in mm labelled m"},
        {1e6, "a time in ms labelled s"},
        {1e-6, "a time in s labelled ms"},
        {-1, "one of both with the wrong sign"}};
    constexpr double close = 0.1;
    for (const Mistake& mistake : mistakes)
        if (std::abs(ratio / mistake.ratio - 1) < close) return &mistake;
    return nullptr;
}

}  // namespace

std::vector<std::string> findContradictions(const Recording& recording) {
    const double interval = recording.sampleInterval();
    if (!(interval > 0)) return {};
    std::map<std::string, std::vector<std::string>> channels;  // by ratio
    for (const Channel& acceleration : recording.channels) {
        auto name = parseChannelName(acceleration.name);
        if (!name || name->derivative != Derivative::acceleration || name->part == Part::base) continue;
        name->derivative = Derivative::displacement;
        const Channel* displacement = recording.find(formatChannelName(*name));
        if (displacement == nullptr) continue;
        const std::optional<double> ratio = calcRatio(*displacement, acceleration, interval);
        if (!ratio || (*ratio > 1 / kLargestRatio && *ratio < kLargestRatio)) continue;
        const Mistake* mistake = explain(*ratio);
        const std::string text = "about " + formatNumber(mistake != nullptr ? mistake->ratio : *ratio, 2) +
                                 " times the second derivative of the displacement beside";
        channels[text + (mistake != nullptr ? " (as from " + std::string(mistake->text) + ")" : "")].push_back(
            acceleration.name);
    }
    std::vector<std::string> sentences;
    for (const auto& [text, names] : channels)
        sentences.push_back("contradiction: " + names.front() +
                            (names.size() > 1 ? " and " + std::to_string(names.size() - 1) + " more are " : " is ") +
                            text);
    return sentences;
}

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
