#include "identify/updating/naming.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

namespace wems::identify::updating {
namespace {

/// Of a normal variable below z.
double calcNormal(double z) {
    return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

const Unknown& rowOf(const TestProblem& problem, int index) {
    return problem.table()[index];
}

double toleranceOf(const Unknown& row) {
    return 2 * row.deviation;
}

/// Whether a statement is of several places, each with a number of its own: two stops, each with its clearance. A
/// factor on several is one number, a rotation is one place.
bool isOfEachPlace(const Hypothesis& hypothesis) {
    return hypothesis.where.size() > 1 && hypothesis.where.size() == hypothesis.directions.size();
}

}  // namespace

std::string describe(const Hypothesis& hypothesis) {
    std::string text = hypothesis.cause;
    for (const auto& place : hypothesis.where) text += " " + place;
    return text;
}

std::vector<std::string> describe(const TestProblem& problem, const HypothesisSet& set) {
    std::vector<std::string> causes;
    for (const int h : set) causes.push_back(describe(problem.hypotheses()[h]));
    return causes;
}

std::string signatureOf(const TestProblem& problem, const HypothesisSet& set) {
    std::vector<std::string> statements;
    for (const int h : set) {
        const Hypothesis& hypothesis = problem.hypotheses()[h];
        std::set<int> moved;
        for (const Direction& direction : hypothesis.directions)
            for (const auto& [column, weight] : direction) {
                const auto probe = std::find_if(hypothesis.moves.begin(), hypothesis.moves.end(),
                                                [own = column](const auto& move) { return move.first == own; });
                moved.insert(probe == hypothesis.moves.end() ? column : probe->second);
            }
        std::string statement = describe(hypothesis);
        for (const int row : moved) statement += " " + std::to_string(row);
        statements.push_back(std::move(statement));
    }
    std::sort(statements.begin(), statements.end());
    std::string text;
    for (const auto& statement : statements) text += statement + "; ";
    return text;
}

bool isSensorFault(const Hypothesis& hypothesis) {
    return hypothesis.cause.rfind("sensor_", 0) == 0;
}

bool isToleranced(const TestProblem& problem, const Hypothesis& hypothesis) {
    // A column beyond the table that moves none of its rows, as a gain over frequency, is a mechanism.
    if (hypothesis.moves.empty())
        for (const Direction& direction : hypothesis.directions)
            for (const auto& [column, weight] : direction)
                if (static_cast<std::size_t>(column) >= problem.table().size()) return false;
    return std::any_of(hypothesis.reported.begin(), hypothesis.reported.end(),
                       [&](int index) { return rowOf(problem, index).deviation > 0; });
}

bool isBeyondTolerance(const TestProblem& problem, const Hypothesis& hypothesis, const TestPoint& point) {
    if (!isToleranced(problem, hypothesis)) return true;
    const bool of_each = isOfEachPlace(hypothesis);
    for (const int index : hypothesis.reported) {
        const Unknown& row = rowOf(problem, index);
        if (!(row.deviation > 0)) continue;
        const bool is_beyond = std::abs(point.values[index] - row.believed) > toleranceOf(row);
        if (is_beyond != of_each) return is_beyond;
    }
    return of_each;
}

bool isFreed(const TestProblem& problem, const HypothesisSet& set, int row) {
    return std::any_of(set.begin(), set.end(), [&](int h) {
        const auto& freed = problem.hypotheses()[h].reported;
        return std::find(freed.begin(), freed.end(), row) != freed.end();
    });
}

double calcRelief(const TestProblem& problem, const SetState& before, const SetState& after) {
    double relief = 0;
    for (int i = 0; i < static_cast<int>(problem.table().size()); ++i) {
        const Unknown& row = rowOf(problem, i);
        const double moved = before.point.values[i] - row.believed;
        if (!(row.deviation > 0) || isFreed(problem, before.set, i) || std::abs(moved) <= toleranceOf(row)) continue;
        // A number within its tolerance costs one by expectation.
        const double left = isFreed(problem, after.set, i) ? row.deviation : after.point.values[i] - row.believed;
        relief += 0.5 * (moved * moved - left * left) / (row.deviation * row.deviation);
    }
    return relief;
}

double calcBeyondProbability(const TestProblem& problem, const Hypothesis& hypothesis, const TestPoint& point,
                             const Posterior& posterior) {
    double largest = 0, least = 1;
    for (const int index : hypothesis.reported) {
        const Unknown& row = rowOf(problem, index);
        if (!(row.deviation > 0)) continue;
        const double error = std::sqrt(std::max(0.0, posterior.covariance(index, index)));
        const double excess = std::abs(point.values[index] - row.believed) - toleranceOf(row);
        const double probability = error > 0 ? calcNormal(excess / error) : (excess > 0 ? 1.0 : 0.0);
        largest = std::max(largest, probability);
        least = std::min(least, probability);
    }
    return isOfEachPlace(hypothesis) ? std::min(least, largest) : largest;
}

bool isPossible(const TestProblem& problem, const HypothesisSet& set, const Eigen::VectorXd& estimate) {
    for (const int h : set)
        for (const Direction& direction : problem.hypotheses()[h].directions)
            for (const auto& [column, weight] : direction) {
                const std::size_t row = column;
                if (row >= problem.table().size()) continue;
                const Unknown& number = problem.table()[row];
                if (number.believed == number.least && estimate[column] < 0) return false;
            }
    return true;
}

bool takesHalf(const Information& all, const Eigen::VectorXd& with, const Eigen::VectorXd& without) {
    return std::any_of(all.begin(), all.end(), [&](const BlockInformation& block) {
        const double left = calcBlockMisfit(block, with);
        return left >= kSatisfied && calcBlockMisfit(block, without) - 1 >= 2 * (left - 1);
    });
}

TestPoint bringBack(const TestProblem& problem, const SetState& state, const Hypothesis& hypothesis) {
    Eigen::VectorXd estimate = problem.estimateOf(state.point);
    for (const int index : hypothesis.reported) {
        const double tolerance = toleranceOf(rowOf(problem, index));
        if (tolerance > 0) estimate[index] = std::clamp(estimate[index], -tolerance, tolerance);
    }
    return problem.pointAt(estimate, state.set);
}

TestPoint holdBack(const TestProblem& problem, const SetState& state, int member, const Evidence& evidence) {
    const Hypothesis& hypothesis = problem.hypotheses()[member];
    HypothesisSet others = state.set;
    others.erase(std::remove(others.begin(), others.end(), member), others.end());
    Eigen::VectorXd estimate = problem.estimateOf(state.point);
    if (!isToleranced(problem, hypothesis) || problem.numbers() == Numbers::exact) {
        estimate += evidence.solve(others).mean - evidence.solve(state.set).mean;
        TestPoint point = problem.reduce(problem.pointAt(estimate, others), others);
        problem.release(point, member);
        return point;
    }
    HypothesisSet with = others;
    with.insert(std::lower_bound(with.begin(), with.end(), member), member);
    std::vector<Eigen::Index> rows;
    for (const int index : hypothesis.reported)
        if (rowOf(problem, index).deviation > 0) rows.push_back(index);
    Eigen::VectorXd change(rows.size());
    for (Eigen::Index i = 0; i < change.size(); ++i) {
        const Eigen::Index row = rows[i];
        const double tolerance = toleranceOf(rowOf(problem, static_cast<int>(row)));
        change[i] = std::clamp(estimate[row], -tolerance, tolerance) - estimate[row];
    }
    const Eigen::MatrixXd covariance = evidence.calcPosterior(with).covariance;
    const Eigen::MatrixXd own = covariance(rows, rows);
    estimate += covariance(Eigen::all, rows) * own.completeOrthogonalDecomposition().solve(change);
    return problem.pointAt(estimate, with);
}

}  // namespace wems::identify::updating
