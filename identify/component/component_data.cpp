#include "identify/component/component_data.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "identify/component/calibration.hpp"
#include "identify/fit/intervals.hpp"
#include "models/common/error.hpp"
#include "models/sampled_motion.hpp"

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

namespace {

constexpr const char* axis_names = "xyz";

Eigen::VectorXd toVector(const std::vector<double>& values) {
    return Eigen::Map<const Eigen::VectorXd>(values.data(), values.size());
}

const Channel* find(const Recording& recording, Part part, const std::string& connection, int axis,
                    Derivative derivative) {
    return recording.find(formatChannelName({part, connection, axis, derivative}));
}

/// Displacement of the mobile end relative to the fixed one, recorded as such or as a difference.
std::optional<Eigen::VectorXd> findRelative(const Recording& recording, const std::string& connection, int axis,
                                            Derivative derivative) {
    if (const auto* relative = find(recording, Part::relative, connection, axis, derivative))
        return toVector(relative->values);
    const auto* mobile = find(recording, Part::mobile, connection, axis, derivative);
    if (!mobile) return std::nullopt;
    const auto* fixed = find(recording, Part::fixed, connection, axis, derivative);
    // No fixed channel at all: the fixed end stands still. Fixed channels, but not this one: cannot be told.
    if (fixed) return Eigen::VectorXd(toVector(mobile->values) - toVector(fixed->values));
    if (recording.connections(Part::fixed).empty()) return toVector(mobile->values);
    return std::nullopt;
}

std::string chooseConnection(const Recording& recording, const std::string& wanted) {
    std::vector<std::string> known;
    for (const auto part : {Part::force, Part::relative, Part::mobile}) {
        for (const auto& name : recording.connections(part))
            if (std::find(known.begin(), known.end(), name) == known.end()) known.push_back(name);
    }
    std::string list;
    for (const auto& name : known) list += (list.empty() ? "" : ", ") + name;
    if (known.empty())
        throw InputError({recording.file, 0, {}}, "no channel of a connection",
                         "relative.<connection>.<q> with force.<connection>.<q> or mobile.<connection>.a<q>");
    if (wanted.empty()) return known.front();
    if (std::find(known.begin(), known.end(), wanted) == known.end())
        throw InputError({recording.file, 0, "--connection"}, "no connection '" + wanted + "' in the recording", list);
    return wanted;
}

int chooseAxis(const Recording& recording, const std::string& connection, std::optional<int> wanted) {
    if (wanted) return *wanted;
    for (int axis = 0; axis < 3; ++axis)
        if (find(recording, Part::force, connection, axis, Derivative::force)) return axis;
    for (int axis = 0; axis < 3; ++axis)
        if (findRelative(recording, connection, axis, Derivative::displacement)) return axis;
    return 0;
}

/// Samples that sit on the channel's own extreme value for three in a row or more: the sensor's range ended there.
std::vector<bool> findClipped(const Eigen::VectorXd& values) {
    std::vector<bool> clipped(values.size(), false);
    const double range = values.maxCoeff() - values.minCoeff();
    for (const double extreme : {values.maxCoeff(), values.minCoeff()}) {
        Eigen::Index run = 0;
        for (Eigen::Index i = 0; i <= values.size(); ++i) {
            const bool at_extreme = i < values.size() && std::abs(values[i] - extreme) <= 1e-4 * range;
            if (at_extreme) {
                ++run;
                continue;
            }
            if (run >= 3) {
                for (Eigen::Index k = i - run; k < i; ++k) clipped[k] = true;
            }
            run = 0;
        }
    }
    return clipped;
}

std::string formatText(const char* format, double value) {
    char buffer[160];
    std::snprintf(buffer, sizeof buffer, format, value);
    return buffer;
}

}  // namespace

bool isComponentTest(const Recording& recording) {
    return !recording.connections(Part::force).empty() || !recording.connections(Part::relative).empty();
}

ComponentData extractComponent(const Recording& recording, const ComponentOptions& options) {
    ComponentData data;
    data.file = recording.file;
    data.connection = chooseConnection(recording, options.connection);
    data.axis = chooseAxis(recording, data.connection, options.axis);
    const std::string place = data.connection + "." + axis_names[data.axis];
    const double interval = recording.sampleInterval();

    const auto q = findRelative(recording, data.connection, data.axis, Derivative::displacement);
    if (!q)
        throw InputError({recording.file, 0, "relative." + place}, "no relative displacement",
                         "relative." + place + ", or mobile." + place + " with fixed." + place);
    const int half_width = chooseHalfWidth(*q);
    auto velocity = findRelative(recording, data.connection, data.axis, Derivative::velocity);
    if (!velocity && !options.time_known) {
        data.has_velocity = false;
        velocity = Eigen::VectorXd::Zero(q->size());
        data.notes.emplace_back("no time recorded: the direction of travel is known, velocity is not");
    } else if (!velocity) {
        velocity = derive(*q, interval, half_width, 1);
        data.notes.push_back(
            formatText("velocity derived from displacement by local parabolas over %.3g ms, zero phase",
                       1e3 * interval * (2 * half_width + 1)));
    }

    Eigen::VectorXd force;
    std::vector<bool> clipped(q->size(), false);
    const auto* recorded = find(recording, Part::force, data.connection, data.axis, Derivative::force);
    if (recorded && !options.mass) {
        // A force that stays at a level is what a friction element or a saturating spring does: not taken for clipping.
        force = toVector(recorded->values);
        data.notes.emplace_back("force as recorded");
    } else {
        if (!options.mass && !options.unit_mass_allowed)
            throw InputError({recording.file, 0, "force." + place},
                             "no force recorded, and no mass to make one from the acceleration",
                             "--mass, or a channel force." + place);
        data.source = ForceSource::mass_times_acceleration;
        data.mass = options.mass.value_or(1.0);
        const auto* measured = find(recording, Part::mobile, data.connection, data.axis, Derivative::acceleration);
        const auto* mobile = find(recording, Part::mobile, data.connection, data.axis, Derivative::displacement);
        if (!measured && !mobile)
            throw InputError({recording.file, 0, "mobile." + data.connection + ".a" + axis_names[data.axis]},
                             "no acceleration of the mobile end", "that channel, or mobile." + place);
        const Eigen::VectorXd acceleration =
            measured ? toVector(measured->values) : derive(toVector(mobile->values), interval, 2 * half_width, 2);
        if (measured) clipped = findClipped(acceleration);
        force = -data.mass * acceleration;
        data.notes.push_back(formatText("force = mass x acceleration of the mobile end, mass %.6g kg", data.mass) +
                             (measured ? "" : ", acceleration derived twice from displacement"));
        data.qualitative = recording.connections(Part::mobile).size() > 1 || (!options.mass && !recorded);
    }

    std::vector<Eigen::Index> kept;
    Eigen::Index dropped = 0;
    for (Eigen::Index i = 0; i < q->size(); ++i) {
        const double t = recording.time[i];
        if (t < options.from.value_or(t) || t > options.to.value_or(t)) continue;
        if (clipped[i]) {
            ++dropped;
        } else {
            kept.push_back(i);
        }
    }
    if (dropped > 0)
        data.notes.push_back(std::to_string(dropped) + " samples left out: the channel sits at the end of its range");
    if (kept.size() < 20)
        throw InputError({recording.file, 0, "--from/--to"},
                         "only " + std::to_string(kept.size()) + " samples in the window",
                         formatText("a window inside the recording's %.6g s", recording.time.front()) +
                             formatText(" to %.6g s with 20 samples or more", recording.time.back()));
    const Eigen::Index n = kept.size();
    for (auto* array : {&data.time, &data.q, &data.velocity, &data.force}) array->resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto from = kept[i];
        data.time[i] = recording.time[from];
        data.q[i] = (*q)[from];
        data.velocity[i] = (*velocity)[from];
        data.force[i] = force[from];
    }
    if (recorded && options.mass) {
        Eigen::VectorXd other(n);
        for (Eigen::Index i = 0; i < n; ++i) other[i] = recorded->values[kept[i]];
        // A force that does not move, as of a channel that was not connected, compares with nothing.
        const ForceComparison comparison = compareForces(data.time, other, data.force);
        if (std::isfinite(comparison.gain_half_width) && std::isfinite(comparison.delay_half_width))
            data.notes.push_back(describe(comparison, gainTolerancesOf(data.source)));
    }
    if (data.q.maxCoeff() - data.q.minCoeff() <= 0)
        throw InputError({recording.file, 0, "relative." + place}, "the displacement is constant in the window",
                         "a window in which the element moves");
    return data;
}

}  // namespace wems::identify
