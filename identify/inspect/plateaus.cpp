#include "identify/inspect/plateaus.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace wems::identify {
namespace {

constexpr std::size_t least_saturated = 6;  // samples
constexpr double band = 7;                  // noise deviations below the extreme value
constexpr double entry_step = 8;            // noise deviations a sample
constexpr long least_piled = 30;            // samples in the band
constexpr double pile_ratio = 8;            // over the bands beside it; 3 for a sine
constexpr std::size_t least_runs = 2;       // at one limit: a single flat peak proves nothing
constexpr int least_excursions = 5;         // that reach the band
constexpr std::size_t least_frozen = 5;     // samples
constexpr double written_steps = 4;         // least band
constexpr double moving = 4;                // resolution steps
constexpr double jump_size = 6;             // noise deviations
constexpr double held_share = 0.1;          // of all samples

struct Run {
    std::size_t begin = 0, end = 0;
};

std::string describeRuns(const std::vector<Run>& runs, const std::vector<double>& time) {
    std::size_t samples = 0;
    for (const Run& run : runs) samples += run.end - run.begin;
    char text[120];
    std::snprintf(text, sizeof text, "%zu %s, %zu samples in all, first at %.6g s", runs.size(),
                  runs.size() == 1 ? "time" : "times", samples, time[runs.front().begin]);
    return text;
}

/// Runs within the band below the largest value of `v` (above the smallest for sign = -1).
std::vector<Run> findSaturated(const std::vector<double>& v, double noise, double sign) {
    double extreme = -std::numeric_limits<double>::infinity();
    for (const double value : v) extreme = std::max(extreme, sign * value);
    // The highest of many noisy values stands some 4 σ above the limit.
    const double floor = extreme - band * noise;
    std::vector<Run> runs;
    for (std::size_t i = 0; i < v.size(); ++i) {
        if (sign * v[i] < floor) continue;
        std::size_t end = i;
        while (end < v.size() && sign * v[end] >= floor) ++end;
        // One sample off the plateau: the step onto it is shortened by the limit.
        const bool before = i >= 2 && sign * (v[i - 1] - v[i - 2]) > entry_step * noise;
        const bool after = end + 1 < v.size() && sign * (v[end] - v[end + 1]) > entry_step * noise;
        if (end - i >= least_saturated && before && after) runs.push_back({i, end});
        i = end;
    }
    return runs;
}

/// Samples in the band below the largest value if they pile up there; none otherwise, or where the largest value is
/// near the middle of the channel (rest).
std::vector<Run> findPile(const std::vector<double>& v, double noise, double sign) {
    const double extreme =
        sign * *(sign > 0 ? std::max_element(v.begin(), v.end()) : std::min_element(v.begin(), v.end()));
    auto sorted = v;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    const double range = *std::max_element(v.begin(), v.end()) - *std::min_element(v.begin(), v.end());
    // Not finer than the values near the limit are written: in one step of them a sine piles up too.
    double next = -std::numeric_limits<double>::infinity();
    for (const double value : v)
        if (sign * value < extreme) next = std::max(next, sign * value);
    const double width = std::max(band * noise, written_steps * (extreme - next));
    // All bands on one side of the middle; behind a single high peak they are not, and nothing piles up there.
    if (extreme - sign * *middle < std::max(4 * width, 0.2 * range)) return {};
    std::array<long, 4> counts{};
    std::vector<Run> pile;
    int excursions = 0;
    bool away = true;
    for (std::size_t i = 0; i < v.size(); ++i) {
        const double below = (extreme - sign * v[i]) / width;
        if (sign * v[i] < sign * *middle) away = true;
        if (below < 1 && away) {
            ++excursions;
            away = false;
        }
        if (below >= 4) continue;
        ++counts.at(static_cast<std::size_t>(below));
        if (below < 1) pile.push_back({i, i + 1});
    }
    const double beside = static_cast<double>(counts[1] + counts[2] + counts[3]) / 3;
    if (counts[0] < least_piled || excursions < least_excursions ||
        static_cast<double>(counts[0]) < pile_ratio * beside)
        pile.clear();
    return pile;
}

/// Smallest change from sample to sample that is not zero.
double findResolution(const std::vector<double>& v) {
    double step = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < v.size(); ++i) {
        const double change = std::abs(v[i] - v[i - 1]);
        if (change > 0 && change < step) step = change;
    }
    return step;
}

std::vector<Run> findFrozen(const std::vector<double>& v, double noise) {
    const auto [low, high] = std::minmax_element(v.begin(), v.end());
    const double lowest = *low, highest = *high;
    double limit = -1;  // found when needed
    std::vector<Run> runs;
    for (std::size_t i = 0; i + least_frozen <= v.size(); ++i) {
        if (v[i + 1] != v[i]) continue;
        std::size_t end = i;
        while (end < v.size() && v[end] == v[i]) ++end;
        const bool extreme = v[i] == lowest || v[i] == highest;
        if (end - i >= least_frozen && !(extreme && v[i] != 0)) {
            if (limit < 0) limit = std::max(moving * findResolution(v), jump_size * noise);
            const bool jump = (i >= 1 && std::abs(v[i] - v[i - 1]) > limit) ||
                              (end < v.size() && std::abs(v[end] - v[end - 1]) > limit);
            const bool moves = (i >= 2 && std::abs(v[i - 1] - v[i - 2]) > 0.5 * limit) ||
                               (end + 1 < v.size() && std::abs(v[end + 1] - v[end]) > 0.5 * limit);
            if (jump && moves) runs.push_back({i, end});
        }
        i = end - 1;
    }
    return runs;
}

}  // namespace

std::vector<Finding> findPlateaus(const Channel& channel, const std::vector<double>& time, double noise, long row) {
    std::vector<Finding> findings;
    const auto& v = channel.values;
    if (v.size() < 16) return findings;
    const auto add = [&](FindingKind kind, const std::vector<Run>& runs, const std::string& what) {
        const std::size_t first = runs.front().begin;
        findings.push_back({kind, channel.name, row + static_cast<long>(first), time[first],
                            channel.name + ": " + what + " " + describeRuns(runs, time)});
    };
    if (noise > 0) {
        for (const double sign : {1.0, -1.0}) {
            auto runs = findSaturated(v, noise, sign);
            if (runs.size() < least_runs) runs = findPile(v, noise, sign);
            if (runs.empty()) continue;
            add(FindingKind::saturated, runs,
                std::string("saturated: flat within its noise at its ") + (sign > 0 ? "largest" : "smallest") +
                    " values");
        }
    }
    const auto frozen = findFrozen(v, noise);
    if (frozen.empty()) return findings;
    std::size_t held = 0;
    for (const Run& run : frozen) held += run.end - run.begin;
    add(FindingKind::drop_out, frozen,
        static_cast<double>(held) > held_share * static_cast<double>(v.size())
            ? "holds each value for several samples, as if sampled more slowly than the others,"
            : "drop-out: the value freezes while the signal moves,");
    return findings;
}

}  // namespace wems::identify
