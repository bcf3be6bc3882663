#include "identify/component/curve_basis.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace wems::identify {

std::vector<std::vector<CurveRow>> makeMonotoneCurves(double lower, double upper, int cells) {
    const double h = (upper - lower) / cells;
    if (!(h > 0)) return {};
    const int first = static_cast<int>(std::floor(lower / h)), last = static_cast<int>(std::ceil(upper / h));
    // Slope over N/m and force over h N/m at the four knots of a B-spline: nothing before, all of it after.
    constexpr std::array<double, 4> slope{0, 0.5, 0.5, 0}, force{0, 1.0 / 6, 5.0 / 6, 1};
    std::vector<std::vector<CurveRow>> curves;
    for (int begin = first - 2; begin < last; ++begin) {
        std::vector<CurveRow> rows;
        for (int knot = first; knot <= last; ++knot) {
            const std::size_t at = std::clamp(knot - begin, 0, 3);
            rows.push_back({knot * h, h * force.at(at), slope.at(at)});
        }
        // A range beside rest: beyond its ends a curve goes on with the slope there.
        const ForceCurve curve(rows);
        const double at_rest = curve.calcForce(0), slope_at_rest = curve.calcStiffness(0);
        if (first > 0) rows.insert(rows.begin(), {0, at_rest, slope_at_rest});
        if (last < 0) rows.push_back({0, at_rest, slope_at_rest});
        for (CurveRow& row : rows) row.force -= at_rest;
        for (CurveRow& row : rows)
            if (row.displacement == 0) row.force = 0;
        curves.push_back(std::move(rows));
    }
    return curves;
}

void addCurve(const std::vector<CurveRow>& part, double weight, std::vector<CurveRow>& curve) {
    if (curve.empty()) {
        curve = part;
        for (CurveRow& row : curve) row.force = row.stiffness.emplace(0);
    }
    for (std::size_t i = 0; i < curve.size(); ++i) {
        curve[i].force += weight * part[i].force;
        *curve[i].stiffness += weight * *part[i].stiffness;
    }
}

}  // namespace wems::identify
