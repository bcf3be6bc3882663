#include "identify/updating/other_form.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>

#include "identify/catalogue/axis_reach.hpp"
#include "identify/component/curve_basis.hpp"

namespace wems::identify::updating {
namespace {

/// Of the range of the displacement: what pushes over a thirteenth of it is met within a fiftieth of its size in eight
/// drawn devices. Other numbers were not tried.
constexpr int kCells = 16;

/// Causes that say a force of the displacement alone.
constexpr std::array<std::string_view, 6> kElastic{
    "cubic_stiffness", "asymmetric_stiffness", "elastomer_stiffness", "stop_stiffness", "clearance", "preload"};

/// Row 3 connection + axis.
std::pair<int, int> splitRow(Eigen::Index row) {
    return {static_cast<int>(row / 3), static_cast<int>(row % 3)};
}

const AxisLaw& lawOf(const MountModel& model, Eigen::Index row) {
    const auto [connection, axis] = splitRow(row);
    return model.connections[static_cast<std::size_t>(connection)].axis.at(static_cast<std::size_t>(axis));
}

/// `4.z`
std::string nameAxis(const MountModel& model, Eigen::Index row) {
    const auto [connection, axis] = splitRow(row);
    return model.connections[static_cast<std::size_t>(connection)].name + "." + "xyz"[axis];
}

/// Rows of the axes of which a cause says an elastic law; none if it says something else.
std::set<Eigen::Index> findAxes(const TestProblem& problem, const Hypothesis& hypothesis) {
    std::set<Eigen::Index> rows;
    if (std::find(kElastic.begin(), kElastic.end(), hypothesis.cause) == kElastic.end()) return rows;
    for (const int index : hypothesis.reported) {
        const Unknown& number = problem.table()[index];
        rows.insert(3 * number.first + number.second);
    }
    return rows;
}

/// Of displacements, m.
struct Range {
    double lower = 0, upper = 0;
};

/// Of some axes in all runs, together.
Range findRange(const TestProblem& problem, const MountModel& model, const std::set<Eigen::Index>& axes) {
    AxisReach reach(model);
    for (const TestRun& run : problem.runs()) reach.widen(run.motion, model);
    Range range;
    for (const Eigen::Index row : axes) {
        range.lower = std::min(range.lower, -reach.negative[row]);
        range.upper = std::max(range.upper, reach.positive[row]);
    }
    return range;
}

/// Curves over a range, the same at each axis: those of one axis after another. Their slopes are those of a spring of
/// 1 N/m at most.
std::vector<AddedCurve> makeCurves(const Range& range, const std::set<Eigen::Index>& axes) {
    std::vector<AddedCurve> curves;
    for (const Eigen::Index row : axes)
        for (auto& rows : makeMonotoneCurves(range.lower, range.upper, kCells)) {
            const auto [connection, axis] = splitRow(row);
            curves.push_back({connection, axis, std::move(rows)});
        }
    return curves;
}

/// A statement is not to lose to a curve because its numbers lie far beyond what is common: its reach holds them.
void widen(Hypothesis& statement, const Eigen::VectorXd& estimate) {
    for (Direction& direction : statement.directions) {
        double beyond = 1;
        for (const auto& [column, weight] : direction) beyond = std::max(beyond, std::abs(estimate[column] / weight));
        for (auto& [column, weight] : direction) weight *= beyond;
    }
}

/// Of what is left beyond the noise, in each block that is not satisfied without.
bool takesHalfOfEach(const std::vector<double>& with, const std::vector<double>& without) {
    for (std::size_t k = 0; k < kBlocks; ++k)
        if (without[k] >= kSatisfied && 2 * (with[k] - 1) > without[k] - 1) return false;
    return true;
}

/// Force (N) of an axis over the displacements of its curves, without them.
Eigen::VectorXd calcForce(const MountModel& model, Eigen::Index row, const std::vector<CurveRow>& at) {
    const AxisForce law(lawOf(model, row));
    Eigen::VectorXd force(static_cast<Eigen::Index>(at.size()));
    for (std::size_t i = 0; i < at.size(); ++i) force[i] = law.calcStaticForce(at[i].displacement);
    return force;
}

/// Law and curves of an axis, within the range. @param posterior of the table's columns, then of the curves
ElasticLaw makeLaw(const TestProblem& problem, const HypothesisSet& set, const std::vector<AddedCurve>& curves,
                   const Range& range, const Posterior& posterior, Eigen::Index row) {
    const std::vector<CurveRow>& at = curves.front().rows;
    const Eigen::Index first = problem.deviations().size();
    const TestPoint point = problem.pointAt(posterior.mean.head(first), set);
    Eigen::VectorXd force = calcForce(point.state.model, row, at);
    Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(force.size(), posterior.mean.size());
    for (std::size_t i = 0; i < problem.table().size(); ++i) {
        const Unknown& number = problem.table()[i];
        if (number.kind != UnknownKind::law || 3 * number.first + number.second != row) continue;
        TestState moved = point.state;
        number.set(moved, point.values[i] + number.step);
        slope.col(i) = (calcForce(moved.model, row, at) - force) / number.step;
    }
    for (std::size_t k = 0; k < curves.size(); ++k) {
        if (3 * curves[k].connection + curves[k].axis != row) continue;
        for (std::size_t i = 0; i < at.size(); ++i) slope(i, first + k) = curves[k].rows[i].force;
    }
    force += slope.rightCols(curves.size()) * posterior.mean.tail(curves.size());
    ElasticLaw law;
    law.where = nameAxis(point.state.model, row);
    const Eigen::VectorXd believed = calcForce(problem.believedPoint().state.model, row, at),
                          variance = (slope * posterior.covariance * slope.transpose()).diagonal();
    for (std::size_t i = 0; i < at.size(); ++i) {
        if (at[i].displacement < range.lower || at[i].displacement > range.upper) continue;
        law.displacement.push_back(at[i].displacement);
        law.believed.push_back(believed[i]);
        law.force.push_back(force[i]);
        law.deviation.push_back(std::sqrt(std::max(0.0, variance[i])));
    }
    return law;
}

Eigen::VectorXd extend(const Eigen::VectorXd& values, Eigen::Index count, double value) {
    Eigen::VectorXd result = Eigen::VectorXd::Constant(values.size() + count, value);
    result.head(values.size()) = values;
    return result;
}

/// @param member whose law the curve stands beside, −1 if there is none
std::optional<OtherForm> offerCurve(const TestProblem& problem, const Settler& settler, const SetState& state,
                                    const std::set<Eigen::Index>& axes, int member, double log_prior) {
    if (axes.empty()) return std::nullopt;
    if (isSatisfied(calcMisfits(sumOf(state.view, true), problem.estimateOf(state.point)))) return std::nullopt;
    const MountModel& model = state.point.state.model;
    double stiffness = 0;
    for (const Eigen::Index row : axes) {
        if (!lawOf(model, row).curve.empty()) return std::nullopt;
        stiffness = std::max(stiffness, lawOf(model, row).stiffness);
    }
    const Range range = findRange(problem, model, axes);
    const std::vector<AddedCurve> curves = makeCurves(range, axes);
    if (curves.empty() || !(stiffness > 0)) return std::nullopt;  // an axis that stands still, or has no elastomer
    const auto count = static_cast<Eigen::Index>(curves.size());
    const Information all = sumOf(problem.view(state.point, state.set, curves), true);
    const std::vector<Direction> tolerances = problem.tolerances(state.set, problem.estimateOf(state.point));
    const Eigen::VectorXd reaches = extend(problem.reaches(), count, stiffness);

    // The set, and one statement more: slopes that differ from the law's by as much as the elastomer's stiffness.
    std::vector<Hypothesis> statements;
    HypothesisSet named;
    for (const int h : state.set) {
        named.push_back(static_cast<int>(statements.size()));
        statements.push_back(problem.hypotheses()[h]);
        if (h == member) widen(statements.back(), problem.estimateOf(state.point));
    }
    HypothesisSet free = named;
    free.push_back(static_cast<int>(statements.size()));
    Hypothesis form;
    form.log_prior = log_prior;
    const auto each = count / static_cast<Eigen::Index>(axes.size());
    for (Eigen::Index i = 0; i < each; ++i) {
        Direction& alike = form.directions.emplace_back();
        for (Eigen::Index k = i; k < count; k += each)
            alike.emplace_back(static_cast<int>(problem.deviations().size() + k), stiffness);
    }
    statements.push_back(std::move(form));

    const auto makeEvidence = [&](const BlockScales& scales) {
        return Evidence(combine(all, scales, reaches), tolerances, statements);
    };
    const auto solve = [&](const HypothesisSet& set) {
        return settler.solveSettled(all, [&](const BlockScales& scales) { return makeEvidence(scales).solve(set); });
    };
    const SetSolution without = solve(named), with = solve(free);
    const std::vector<double> left = calcMisfits(all, with.mean);
    if (!takesHalfOfEach(left, calcMisfits(all, without.mean))) return std::nullopt;
    OtherForm found;
    found.log_odds = settler.calcLogEvidence(all, with) - settler.calcLogEvidence(all, without);
    const Posterior posterior = makeEvidence(settler.scalesOf(left)).calcPosterior(free);
    for (const Eigen::Index row : axes)
        found.laws.push_back(makeLaw(problem, state.set, curves, range, posterior, row));
    return found;
}

}  // namespace

std::optional<OtherForm> findOtherForm(const TestProblem& problem, const Settler& settler, const SetState& state,
                                       int member) {
    const Hypothesis& hypothesis = problem.hypotheses()[member];
    return offerCurve(problem, settler, state, findAxes(problem, hypothesis), member, hypothesis.log_prior);
}

std::vector<ElasticLaw> findElasticLaw(const TestProblem& problem, const Settler& settler, const SetState& state,
                                       const std::string& place) {
    std::set<Eigen::Index> axis;
    const auto& connections = state.point.state.model.connections;
    const auto rows = static_cast<Eigen::Index>(3 * connections.size());
    for (Eigen::Index row = 0; row < rows; ++row)
        if (nameAxis(state.point.state.model, row) == place) axis.insert(row);
    const auto found = offerCurve(problem, settler, state, axis, -1, -std::log(static_cast<double>(rows)));
    return found && found->log_odds > 0 ? found->laws : std::vector<ElasticLaw>{};
}

}  // namespace wems::identify::updating
