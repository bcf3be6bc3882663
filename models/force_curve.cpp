#include "models/force_curve.hpp"

#include <algorithm>
#include <cmath>

#include "models/common/format_number.hpp"

namespace wems {

namespace {

/// At the first of two intervals, by the parabola through three rows; within what keeps the curve monotone.
/// @param h, d lengths and mean slopes of that interval and the next
double calcEndSlope(double h0, double h1, double d0, double d1) {
    const double slope = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
    if (slope * d0 <= 0) return 0;
    return d0 * d1 <= 0 && std::abs(slope) > 3 * std::abs(d0) ? 3 * d0 : slope;
}

double calcInnerSlope(double h0, double h1, double d0, double d1) {
    if (d0 * d1 <= 0) return 0;
    const double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
    return (w0 + w1) / (w0 / d0 + w1 / d1);
}

std::vector<double> calcSlopes(const std::vector<CurveRow>& rows) {
    const std::size_t last = rows.size() - 1;
    std::vector<double> length, mean;
    for (std::size_t i = 0; i < last; ++i) {
        length.push_back(rows[i + 1].displacement - rows[i].displacement);
        mean.push_back((rows[i + 1].force - rows[i].force) / length[i]);
    }
    std::vector<double> slopes;
    for (std::size_t i = 0; i <= last; ++i) {
        if (rows[i].stiffness)
            slopes.push_back(*rows[i].stiffness);
        else if (last == 1)
            slopes.push_back(mean[0]);
        else if (i == 0)
            slopes.push_back(calcEndSlope(length[0], length[1], mean[0], mean[1]));
        else if (i == last)
            slopes.push_back(calcEndSlope(length[i - 1], length[i - 2], mean[i - 1], mean[i - 2]));
        else
            slopes.push_back(calcInnerSlope(length[i - 1], length[i], mean[i - 1], mean[i]));
    }
    return slopes;
}

}  // namespace

std::optional<CurveProblem> findProblem(const std::vector<CurveRow>& rows) {
    if (rows.size() < 2) return CurveProblem{"has " + std::to_string(rows.size()) + " rows", "two rows at least"};
    bool rests = false;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const CurveRow& row = rows[i];
        const int at = static_cast<int>(i);
        if (!std::isfinite(row.displacement) || !std::isfinite(row.force) || !std::isfinite(row.stiffness.value_or(0)))
            return CurveProblem{"holds no finite numbers", "displacement (m), force (N) and perhaps slope (N/m)", at};
        if (i > 0 && !(row.displacement > rows[i - 1].displacement))
            return CurveProblem{"has the displacement " + formatNumber(row.displacement), "ascending displacements, m",
                                at};
        if (i > 0 &&
            !std::isfinite((row.force - rows[i - 1].force) / std::pow(row.displacement - rows[i - 1].displacement, 3)))
            return CurveProblem{"is too near to the row before", "displacements in m, forces in N", at};
        rests = rests || (row.displacement == 0 && row.force == 0);
    }
    if (!rests)
        return CurveProblem{"does not pass through rest",
                            "a row [0.0, 0.0]: displacements count from where the element exerts nothing"};
    return std::nullopt;
}

ForceCurve::ForceCurve(const std::vector<CurveRow>& rows) {
    if (rows.empty()) return;
    const std::vector<double> slopes = calcSlopes(rows);
    for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
        const double h = rows[i + 1].displacement - rows[i].displacement;
        const double mean = (rows[i + 1].force - rows[i].force) / h, s0 = slopes[i], s1 = slopes[i + 1];
        segments_.push_back(
            {rows[i].displacement, h, rows[i].force, s0, (3 * mean - 2 * s0 - s1) / h, (s0 + s1 - 2 * mean) / (h * h)});
    }
    last_ = rows.back().displacement;
    last_force_ = rows.back().force;
    last_slope_ = slopes.back();
    work_to_rest_ = calcWorkFromStart(0);
}

double ForceCurve::calcForce(double q) const {
    if (segments_.empty()) return 0;
    if (q >= last_) return last_force_ + last_slope_ * (q - last_);
    const Segment& first = segments_.front();
    if (q < first.from) return first.value + first.slope * (q - first.from);
    const auto after = std::upper_bound(segments_.begin(), segments_.end(), q,
                                        [](double at, const Segment& segment) { return at < segment.from; });
    return std::prev(after)->calcForce(q - std::prev(after)->from);
}

double ForceCurve::calcStiffness(double q) const {
    if (segments_.empty()) return 0;
    if (q >= last_) return last_slope_;
    if (q < segments_.front().from) return segments_.front().slope;
    const auto after = std::upper_bound(segments_.begin(), segments_.end(), q,
                                        [](double at, const Segment& segment) { return at < segment.from; });
    return std::prev(after)->calcStiffness(q - std::prev(after)->from);
}

double ForceCurve::calcWorkFromStart(double q) const {
    const Segment& first = segments_.front();
    const double before = std::min(0.0, q - first.from), after = std::max(0.0, q - last_);
    double work = before * (first.value + first.slope * before / 2) + after * (last_force_ + last_slope_ * after / 2);
    for (const Segment& segment : segments_)
        work += segment.calcWork(std::clamp(q - segment.from, 0.0, segment.length));
    return work;
}

double ForceCurve::calcPotential(double q) const {
    return segments_.empty() ? 0 : calcWorkFromStart(q) - work_to_rest_;
}

double ForceCurve::largestStiffness() const {
    double largest = last_slope_;
    for (const Segment& segment : segments_) {
        largest = std::max(largest, segment.slope);
        if (segment.cube >= 0) continue;  // its slope is largest at an end
        const double top = std::clamp(-segment.square / (3 * segment.cube), 0.0, segment.length);
        largest = std::max(largest, segment.calcStiffness(top));
    }
    return largest;
}

void ForceCurve::appendConstants(std::vector<double>& constants) const {
    if (segments_.empty()) return;
    const Segment& first = segments_.front();
    constants.insert(constants.end(), {first.value, first.from, first.slope, last_, last_slope_});
    for (const Segment& segment : segments_)
        constants.insert(constants.end(), {segment.from, segment.length, segment.slope, segment.square, segment.cube});
}

std::vector<CurveRow> subtractSpring(std::vector<CurveRow> rows, double stiffness) {
    // Slopes first: those that come from the neighbours are not those of the rows that are left.
    const ForceCurve curve(rows);
    for (CurveRow& row : rows) {
        row.stiffness = curve.calcStiffness(row.displacement) - stiffness;
        row.force -= stiffness * row.displacement;
    }
    return rows;
}

}  // namespace wems
