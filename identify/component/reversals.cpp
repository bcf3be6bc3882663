#include "identify/component/reversals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/fit/student.hpp"

namespace wems::identify {
namespace {

double calcMedian(std::vector<double> values) {
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    if (values.size() % 2 == 1) return *middle;
    return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

/// A stroke: samples [begin, end] between two reversals.
struct Stroke {
    Eigen::Index begin, end;
    int direction;
};

std::vector<Stroke> findStrokes(const Eigen::VectorXd& q) {
    const auto reversals = findReversals(q, 0.05);
    std::vector<Stroke> strokes;
    for (std::size_t i = 0; i + 1 < reversals.size(); ++i)
        strokes.push_back({reversals[i].index, reversals[i + 1].index, reversals[i].direction});
    double longest = 0;
    for (const auto& s : strokes) longest = std::max(longest, std::abs(q[s.end] - q[s.begin]));
    strokes.erase(std::remove_if(strokes.begin(), strokes.end(),
                                 [&](const Stroke& s) { return std::abs(q[s.end] - q[s.begin]) < 0.8 * longest; }),
                  strokes.end());
    return strokes;
}

}  // namespace

Eigen::VectorXd calcDirection(const Eigen::VectorXd& q, double fraction) {
    const auto reversals = findReversals(q, fraction);
    Eigen::VectorXd direction(q.size());
    int now = reversals.empty() ? (q[q.size() - 1] >= q[0] ? 1 : -1) : -reversals.front().direction;
    std::size_t next = 0;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
        if (next < reversals.size() && i == reversals[next].index) now = reversals[next++].direction;
        direction[i] = now;
    }
    return direction;
}

Eigen::VectorXd calcTravel(const Eigen::VectorXd& q, double fraction) {
    const auto reversals = findReversals(q, fraction);
    Eigen::VectorXd travel = Eigen::VectorXd::Constant(q.size(), std::numeric_limits<double>::quiet_NaN());
    std::size_t next = 0;
    double start = 0;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
        if (next < reversals.size() && i == reversals[next].index) start = q[reversals[next++].index];
        if (next > 0) travel[i] = std::abs(q[i] - start);
    }
    return travel;
}

std::vector<bool> findFullStrokes(const Eigen::VectorXd& q) {
    std::vector<bool> full(q.size(), false);
    for (const auto& stroke : findStrokes(q))
        for (Eigen::Index i = stroke.begin; i <= stroke.end; ++i) full[i] = true;
    return full;
}

StrokeStatistic summariseStrokes(std::vector<double> values) {
    StrokeStatistic statistic;
    statistic.value = calcMedian(values);
    const auto n = static_cast<double>(values.size());
    double half = std::numeric_limits<double>::infinity();
    if (values.size() > 1) {
        double mean = 0, square = 0;
        for (const double x : values) mean += x / n;
        for (const double x : values) square += (x - mean) * (x - mean) / (n - 1);
        // √(π/2): efficiency of the median against the mean for normal scatter.
        half = studentQuantile95(n - 1) * std::sqrt(0.5 * 3.14159265358979 * square / n);
    }
    statistic.lower = statistic.value - half;
    statistic.upper = statistic.value + half;
    statistic.strokes = std::move(values);
    return statistic;
}

StrokeSummary summariseFriction(const Eigen::VectorXd& q, const Eigen::VectorXd& force, double low_force) {
    StrokeSummary summary;
    const auto strokes = findStrokes(q);
    std::vector<double> levels[2], changes;
    double energy = 0, travel_sum = 0, travel_towards[2] = {0, 0};
    for (const auto& stroke : strokes) {
        const double travel = std::abs(q[stroke.end] - q[stroke.begin]);
        std::vector<double> second_half, third_quarter, fourth_quarter;
        for (Eigen::Index i = stroke.begin; i <= stroke.end; ++i) {
            const double part = std::abs(q[i] - q[stroke.begin]) / travel;
            if (part > 0.5) second_half.push_back(force[i]);
            if (part > 0.5 && part <= 0.75) third_quarter.push_back(force[i]);
            if (part > 0.75) fourth_quarter.push_back(force[i]);
            if (i > stroke.begin) energy += 0.5 * (force[i] + force[i - 1]) * (q[i] - q[i - 1]);
        }
        travel_sum += travel;
        travel_towards[stroke.direction > 0 ? 0 : 1] += travel;
        levels[stroke.direction > 0 ? 0 : 1].push_back(calcMedian(second_half));
        changes.push_back(2.0 * std::abs(calcMedian(fourth_quarter) - calcMedian(third_quarter)));
    }
    summary.positive_level = summariseStrokes(levels[0]);
    summary.negative_level = summariseStrokes(levels[1]);
    const double level = 0.5 * (summary.positive_level.value - summary.negative_level.value);
    const auto share = [&](const StrokeStatistic& s, double travel) { return travel > 0 ? s.value * travel : 0.0; };
    summary.loop_fill =
        energy / (share(summary.positive_level, travel_towards[0]) - share(summary.negative_level, travel_towards[1]));
    summary.flatness = calcMedian(changes) / std::abs(level);
    summary.low_force = low_force > 0 ? low_force : 0.05 * std::abs(level);

    summary.stroke = strokes.empty() ? 0.0 : travel_sum / static_cast<double>(strokes.size());

    std::vector<double> gaps[3], rises;
    for (const auto& stroke : strokes) {
        Eigen::Index first = -1, last = -1;
        for (Eigen::Index i = stroke.begin; i <= stroke.end; ++i) {
            if (std::abs(force[i]) >= summary.low_force) continue;
            if (first < 0) first = i;
            last = i;
        }
        if (first >= 0) {
            Eigen::Index before = first, after = last;
            while (before > stroke.begin && std::abs(force[before]) < 3.0 * summary.low_force) --before;
            while (after < stroke.end && std::abs(force[after]) < 3.0 * summary.low_force) ++after;
            rises.push_back(0.5 * (std::abs(q[first] - q[before]) + std::abs(q[after] - q[last])));
        }
        const double gap = first < 0 ? 0.0 : std::abs(q[last] - q[first]);
        gaps[2].push_back(gap);
        gaps[stroke.direction < 0 ? 0 : 1].push_back(gap);
    }
    summary.gap_after_positive = summariseStrokes(gaps[0]);
    summary.gap_after_negative = summariseStrokes(gaps[1]);
    summary.gap = summariseStrokes(gaps[2]);
    summary.rise = rises.empty() ? 0.0 : calcMedian(rises);
    return summary;
}

}  // namespace wems::identify
