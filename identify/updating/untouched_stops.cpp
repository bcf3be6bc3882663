#include "identify/updating/untouched_stops.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "identify/catalogue/axis_reach.hpp"
#include "identify/updating/settling.hpp"
#include "models/common/format_number.hpp"

namespace wems::identify::updating {
namespace {

// From depth to depth. A force that is x times the true one leaves (x − 1)² of what that takes; of x and x/4 the better
// leaves 0.36 at most, at x = 1.6.
constexpr double kShallower = 4;
// From half the tolerance down to 1/1024 of that: 0.02 µm where 50 µm are believed. For time, not varied.
constexpr int kDepths = 6;
// Of the depth: over how much of it the slope of a curve, which is smooth, becomes the stop's. Between, the force errs
// by 4/27 of that part of the force at the depth. Not varied.
constexpr double kKink = 1e-3;

/// The force of a stop at a clearance that leaves it a depth, over displacements to three times that clearance.
AddedCurve makeContact(const UntouchedStop& stop, double depth) {
    const double side = stop.stop.side == Side::positive ? 1 : -1, k = stop.stop.stiffness;
    const double clearance = stop.reached - depth, end = 3 * clearance;
    std::vector<CurveRow> rows{
        {-end, 0, 0}, {0, 0, 0}, {clearance - kKink * depth, 0, 0}, {clearance, 0, k}, {end, k * (end - clearance), k}};
    if (side < 0) std::reverse(rows.begin(), rows.end());
    for (CurveRow& row : rows) {
        row.displacement = side * row.displacement - stop.offset;
        row.force *= side;
    }
    return {stop.connection, stop.axis, std::move(rows)};
}

}  // namespace

std::vector<UntouchedStop> findUntouchedStops(const TestProblem& problem, const TestPoint& point) {
    const MountModel& model = point.state.model;
    AxisReach reach(model);
    for (const TestRun& run : *problem.correctRuns(point)) reach.widen(run.motion, model);
    std::vector<UntouchedStop> stops;
    for (int i = 0; i < static_cast<int>(model.connections.size()); ++i)
        for (int a = 0; a < 3; ++a) {
            const AxisLaw& law = model.connections[static_cast<std::size_t>(i)].axis[static_cast<std::size_t>(a)];
            if (!law.curve.empty()) continue;
            for (const Stop& stop : law.stops) {
                const bool positive = stop.side == Side::positive;
                const std::string place = model.connections[static_cast<std::size_t>(i)].name + "." + kAxes[a];
                const int row = findUnknown(problem.table(), place + (positive ? ".+" : ".-") + ".clearance");
                if (row < 0 || !(stop.stiffness > 0)) continue;
                const Unknown& number = problem.table()[static_cast<std::size_t>(row)];
                const double reached =
                    positive ? reach.positive[3 * i + a] + law.offset : reach.negative[3 * i + a] - law.offset;
                const double nearest = number.believed - 2 * number.deviation;
                if (stop.clearance >= reached && nearest < reached)
                    stops.push_back({i, a, stop, law.offset, row, reached, nearest});
            }
        }
    return stops;
}

/// What a contact adds grows with its depth, so that any depth below the true one leaves less than none does: of depths
/// that are each a quarter of the one before, one is such. What each would leave follows from its force to first order.
bool Settler::reachStops(SetState& state, bool with_validation) const {
    const std::vector<UntouchedStop> stops = findUntouchedStops(problem_, state.point);
    if (stops.empty()) return false;
    const Eigen::VectorXd here = problem_.estimateOf(state.point);
    std::vector<AddedCurve> curves;
    std::vector<double> depths;
    for (const UntouchedStop& stop : stops)
        for (int d = 0; d < kDepths; ++d) {
            depths.push_back(0.5 * (stop.reached - stop.nearest) * std::pow(kShallower, -d));
            curves.push_back(makeContact(stop, depths.back()));
        }
    const Information all = sumOf(problem_.viewAlone(state.point, curves), with_validation);
    const Information present = sumOf(state.view, with_validation);
    const std::vector<double> misfits = calcMisfits(present, here);
    const BlockScales scales = scalesOf(misfits);
    Eigen::VectorXd columns = Eigen::VectorXd::Zero(here.size() + static_cast<Eigen::Index>(curves.size()));
    columns.head(here.size()) = here;
    const auto leave = [&] {
        double sum = 0;
        for (std::size_t k = 0; k < kBlocks; ++k)
            if (!all[k].empty()) sum += calcBlockMisfit(all[k], columns) * all[k].count / scales[k].scale;
        return sum;
    };
    const double without = leave(), prior = calcPriorSquare(here, state.set);
    Eigen::VectorXd touched = here;
    for (std::size_t s = 0; s < stops.size(); ++s) {
        double most = 2 * kSettled;
        for (std::size_t c = s * kDepths; c < (s + 1) * kDepths; ++c) {
            Eigen::VectorXd own = here;
            own[stops[s].row] =
                stops[s].reached - depths[c] - problem_.table()[static_cast<std::size_t>(stops[s].row)].believed;
            double& force = columns[here.size() + static_cast<Eigen::Index>(c)];
            force = 1;
            const double gain = without - leave() + prior - calcPriorSquare(own, state.set);
            force = 0;
            if (!(gain > most)) continue;
            most = gain;
            touched[stops[s].row] = own[stops[s].row];
        }
    }
    if (touched == here) return false;
    const TestPoint next = problem_.pointAt(touched, state.set);
    const Information actual = calcActual(next, with_validation);
    const double after = calcCost(actual, calcMeanSquares(actual)) + calcPriorSquare(touched, state.set);
    if (!(calcCost(present, misfits) + prior - after > 2 * kSettled)) return false;
    state.point = next;
    state.view = problem_.view(state.point, state.set);
    return true;
}

}  // namespace wems::identify::updating
