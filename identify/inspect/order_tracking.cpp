#include "identify/inspect/order_tracking.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "models/common/units.hpp"

namespace wems::identify {

namespace {

constexpr double window_periods = 5;
constexpr int unknowns = 1 + 2 * tracked_orders;

/// Phase of the drive at each sample, trapezoidal; NaN frequencies continue the one before.
std::vector<double> integratePhase(const std::vector<double>& time, const Eigen::VectorXd& hertz) {
    std::vector<double> phase(time.size(), 0.0);
    for (std::size_t k = 1; k < time.size(); ++k) {
        const Eigen::Index i = k;
        const double f = 0.5 * (hertz[i] + hertz[i - 1]);
        phase[k] = phase[k - 1] + (std::isfinite(f) ? kTwoPi * f * (time[k] - time[k - 1]) : 0.0);
    }
    return phase;
}

/// Samples at which the swept frequency passes through `points` values evenly spaced in its logarithm.
std::vector<std::size_t> choosePoints(const SweptFrequency& swept, int points) {
    std::vector<std::size_t> samples;
    const bool sweeps = swept.highest > 1.05 * swept.lowest;
    const Eigen::Index n = swept.hertz.size();
    double last = std::numeric_limits<double>::quiet_NaN();
    const double step = sweeps ? std::log(swept.highest / swept.lowest) / points : 0;
    for (Eigen::Index k = 0; k < n; ++k) {
        if (!std::isfinite(swept.hertz[k])) continue;
        const double x = sweeps ? std::log(swept.hertz[k]) : static_cast<double>(k);
        const double distance = sweeps ? step : static_cast<double>(n) / points;
        if (std::isfinite(last) && std::abs(x - last) < distance) continue;
        last = x;
        samples.push_back(k);
    }
    return samples;
}

/// Group of channels that `source` of a swept frequency names.
bool isOfSource(const ChannelName& name, const std::string& source) {
    switch (name.part) {
        case Part::load:
            return source == "load";
        case Part::base:
            return source == "base";
        case Part::fixed:
            return source == "fixed part";
        case Part::mobile:
            return source == "mobile part";
        default:
            return false;
    }
}

const Channel* findReference(const Recording& recording, const SweptFrequency& swept) {
    const Channel* best = nullptr;
    double largest = 0;
    for (const Channel& channel : recording.channels) {
        const auto name = parseChannelName(channel.name);
        if (!name || !isOfSource(*name, swept.source)) continue;
        const Eigen::Map<const Eigen::VectorXd> values(channel.values.data(), channel.values.size());
        const double power = (values.array() - values.mean()).square().sum();
        if (power > largest) {
            largest = power;
            best = &channel;
        }
    }
    return best;
}

}  // namespace

OrderTracking trackOrders(const Recording& recording, const SweptFrequency& swept, int points) {
    OrderTracking result;
    if (!swept.is_sine) return result;
    const auto samples = choosePoints(swept, points);
    const auto phase = integratePhase(recording.time, swept.hertz);
    const Eigen::Index count = samples.size();
    for (const std::size_t k : samples) {
        result.time.push_back(recording.time[k]);
        result.hertz.push_back(swept.hertz[k]);
    }
    const double nothing = std::numeric_limits<double>::quiet_NaN();
    for (const Channel& channel : recording.channels)
        result.tracks.push_back({channel.name, Eigen::MatrixXd::Constant(tracked_orders, count, nothing),
                                 Eigen::MatrixXd::Constant(tracked_orders, count, nothing)});
    const double interval = recording.sampleInterval();
    for (Eigen::Index p = 0; p < count; ++p) {
        const std::size_t k = samples[p];
        const auto half = static_cast<std::size_t>(0.5 * window_periods / (result.hertz[p] * interval));
        if (half < static_cast<std::size_t>(unknowns) || k < half || k + half >= recording.time.size()) continue;
        const Eigen::Index rows = 2 * half + 1;
        Eigen::MatrixXd design(rows, unknowns);
        for (Eigen::Index i = 0; i < rows; ++i) {
            const double angle = phase[k - half + static_cast<std::size_t>(i)];
            design(i, 0) = 1;
            for (int order = 1; order <= tracked_orders; ++order) {
                design(i, 2 * order - 1) = std::cos(order * angle);
                design(i, 2 * order) = std::sin(order * angle);
            }
        }
        const Eigen::LDLT<Eigen::MatrixXd> solver(design.transpose() * design);
        for (std::size_t c = 0; c < recording.channels.size(); ++c) {
            const Eigen::Map<const Eigen::VectorXd> values(recording.channels[c].values.data() + (k - half), rows);
            const Eigen::VectorXd x = solver.solve(design.transpose() * values);
            for (int order = 1; order <= tracked_orders; ++order) {
                const double a = x[2 * order - 1], b = x[2 * order];
                result.tracks[c].amplitude(order - 1, p) = std::hypot(a, b);
                result.tracks[c].phase(order - 1, p) = std::atan2(-b, a);  // of cos(φ + phase)
            }
        }
    }
    const Channel* reference = findReference(recording, swept);
    if (reference == nullptr) return result;
    result.reference = reference->name;
    const std::size_t index = reference - recording.channels.data();
    const Eigen::RowVectorXd zero = result.tracks[index].phase.row(0);
    for (OrderTrack& track : result.tracks) {
        for (int order = 1; order <= tracked_orders; ++order) {
            for (Eigen::Index p = 0; p < count; ++p)
                track.phase(order - 1, p) = std::remainder(track.phase(order - 1, p) - order * zero[p], kTwoPi);
        }
    }
    return result;
}

namespace {

constexpr double bands_a_decade = 100;

}  // namespace

void OrderEnvelope::add(const OrderTracking& block) {
    if (block.tracks.empty()) return;
    if (channels_.empty()) {
        reference_ = block.reference;
        for (const OrderTrack& track : block.tracks) channels_.push_back(track.channel);
    }
    if (block.reference != reference_ || block.tracks.size() != channels_.size()) return;
    const auto reference =
        std::find(channels_.begin(), channels_.end(), reference_) - channels_.begin();  // the end without one
    for (std::size_t p = 0; p < block.time.size(); ++p) {
        const Eigen::Index column = p;
        const auto& drive = block.tracks[reference_.empty() ? 0 : static_cast<std::size_t>(reference)];
        const double level = drive.amplitude(0, column);
        if (!(level > 0)) continue;  // nor where there is none
        Point& point = points_[std::lround(bands_a_decade * std::log10(block.hertz[p]))];
        if (!(level > point.level)) continue;
        const Eigen::Index count = block.tracks.size();
        point = {block.time[p], block.hertz[p], Eigen::MatrixXd(tracked_orders, count),
                 Eigen::MatrixXd(tracked_orders, count), level};
        for (Eigen::Index c = 0; c < count; ++c) {
            const OrderTrack& track = block.tracks[c];
            point.amplitude.col(c) = track.amplitude.col(column);
            point.phase.col(c) = track.phase.col(column);
        }
    }
}

OrderTracking OrderEnvelope::finish() const {
    OrderTracking result;
    result.reference = reference_;
    const Eigen::Index count = points_.size();
    for (const auto& name : channels_)
        result.tracks.push_back({name, Eigen::MatrixXd(tracked_orders, count), Eigen::MatrixXd(tracked_orders, count)});
    Eigen::Index p = 0;
    for (const auto& [band, point] : points_) {
        result.time.push_back(point.time);
        result.hertz.push_back(point.hertz);
        for (std::size_t c = 0; c < channels_.size(); ++c) {
            result.tracks[c].amplitude.col(p) = point.amplitude.col(c);
            result.tracks[c].phase.col(p) = point.phase.col(c);
        }
        ++p;
    }
    return result;
}

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
