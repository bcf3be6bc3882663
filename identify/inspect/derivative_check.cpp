#include "identify/inspect/derivative_check.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "identify/inspect/segment_spectra.hpp"
#include "models/format_number.hpp"
#include "models/pi.hpp"

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

}  // namespace wems::identify
