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

/// Of the range of the displacement. A force that rises and falls again over a tenth of the range needs so many.
constexpr int kCells = 16;

/// Causes that say a force of the displacement alone.
constexpr std::array<std::string_view, 5> kElastic{"cubic_stiffness", "elastomer_stiffness", "stop_stiffness",
                                                   "clearance", "preload"};

/// Row 3 connection + axis.
std::pair<int, int> splitRow(Eigen::Index row) {
    return {static_cast<int>(row / 3), static_cast<int>(row % 3)};
}

const AxisLaw& lawOf(const MountModel& model, Eigen::Index row) {
    const auto [connection, axis] = splitRow(row);
    return model.connections[static_cast<std::size_t>(connection)].axis.at(static_cast<std::size_t>(axis));
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

/// Curves over the range of some axes in all runs, the same at each: those of one axis after another. Their slopes are
/// those of a spring of 1 N/m at most.
std::vector<AddedCurve> makeCurves(const TestProblem& problem, const MountModel& model,
                                   const std::set<Eigen::Index>& axes) {
    AxisReach reach(model);
    for (const TestRun& run : problem.runs()) reach.widen(run.motion, model);
    double lower = 0, upper = 0;
    for (const Eigen::Index row : axes) {
        lower = std::min(lower, -reach.negative[row]);
        upper = std::max(upper, reach.positive[row]);
    }
    std::vector<AddedCurve> curves;
    for (const Eigen::Index row : axes)
        for (auto& rows : makeMonotoneCurves(lower, upper, kCells)) {
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

/// Of what is left beyond the noise in each block that is not satisfied.
bool takesHalf(const std::vector<double>& with, const std::vector<double>& without) {
    for (std::size_t k = 0; k < kBlocks; ++k)
        if (without[k] >= kSatisfied && 2 * (with[k] - 1) > without[k] - 1) return false;
    return true;
}

Eigen::VectorXd extend(const Eigen::VectorXd& values, Eigen::Index count, double value) {
    Eigen::VectorXd result = Eigen::VectorXd::Constant(values.size() + count, value);
    result.head(values.size()) = values;
    return result;
}

}  // namespace

std::optional<double> calcOtherFormOdds(const TestProblem& problem, const Settler& settler, const SetState& state,
                                        int member) {
    if (isSatisfied(calcMisfits(sumOf(state.view, true), problem.estimateOf(state.point)))) return std::nullopt;
    const MountModel& model = state.point.state.model;
    const std::set<Eigen::Index> axes = findAxes(problem, problem.hypotheses()[member]);
    if (axes.empty()) return std::nullopt;
    double stiffness = 0;
    for (const Eigen::Index row : axes) {
        if (!lawOf(model, row).curve.empty()) return std::nullopt;
        stiffness = std::max(stiffness, lawOf(model, row).stiffness);
    }
    const std::vector<AddedCurve> curves = makeCurves(problem, model, axes);
    const auto count = static_cast<Eigen::Index>(curves.size());
    const Information all = sumOf(problem.view(state.point, state.set, curves), true);
    const Eigen::VectorXd deviations = extend(problem.deviations(), count, 0);
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
    form.log_prior = problem.hypotheses()[member].log_prior;
    const auto each = count / static_cast<Eigen::Index>(axes.size());
    for (Eigen::Index i = 0; i < each; ++i) {
        Direction& alike = form.directions.emplace_back();
        for (Eigen::Index k = i; k < count; k += each)
            alike.emplace_back(static_cast<int>(problem.deviations().size() + k), stiffness);
    }
    statements.push_back(std::move(form));

    const auto solve = [&](const HypothesisSet& set) {
        return settler.solveSettled(all, [&](const BlockScales& scales) {
            return Evidence(combine(all, scales, reaches), deviations, statements).solve(set);
        });
    };
    const SetSolution without = solve(named), with = solve(free);
    if (!takesHalf(calcMisfits(all, with.mean), calcMisfits(all, without.mean))) return std::nullopt;
    return settler.calcLogEvidence(all, with) - settler.calcLogEvidence(all, without);
}

}  // namespace wems::identify::updating
