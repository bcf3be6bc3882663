#include "identify/component/friction_model.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/component/block_regression.hpp"

namespace wems::identify {
namespace {

/// Force for levels of one: what F₊ and F₋ multiply.
struct UnitForces {
    Eigen::VectorXd positive, negative;
};

UnitForces calcUnitForces(double presliding, double gap, const Eigen::VectorXd& q) {
    const double limit = presliding + 0.5 * gap;
    UnitForces unit{Eigen::VectorXd(q.size()), Eigen::VectorXd(q.size())};
    double e = 0;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
        if (i > 0) e = std::clamp(e + q[i] - q[i - 1], -limit, limit);
        unit.positive[i] = std::max(e - 0.5 * gap, 0.0) / presliding;
        unit.negative[i] = std::min(e + 0.5 * gap, 0.0) / presliding;
    }
    return unit;
}

/// All tests one below the other.
struct Problem {
    std::vector<Eigen::VectorXd> q;
    Eigen::VectorXd force;
    std::vector<Eigen::Index> starts;

    Eigen::MatrixXd makeColumns(double presliding, double gap) const {
        Eigen::MatrixXd X(force.size(), 2);
        for (std::size_t r = 0; r < q.size(); ++r) {
            const UnitForces unit = calcUnitForces(presliding, gap, q[r]);
            X.col(0).segment(starts[r], q[r].size()) = unit.positive;
            X.col(1).segment(starts[r], q[r].size()) = unit.negative;
        }
        return X;
    }

    Eigen::Vector2d solveLevels(const Eigen::MatrixXd& X) const {
        Eigen::Matrix2d normal = X.transpose() * X;
        normal.diagonal().array() += 1e-12 * (1.0 + normal.trace());
        return normal.ldlt().solve(X.transpose() * force);
    }

    double calcCost(double presliding, double gap) const {
        const Eigen::MatrixXd X = makeColumns(presliding, gap);
        return (force - X * solveLevels(X)).squaredNorm();
    }
};

Problem stack(const std::vector<ComponentData>& tests, Eigen::Index at_most) {
    Problem problem;
    Eigen::Index count = 0;
    std::vector<Eigen::Index> strides;
    for (const auto& test : tests) {
        strides.push_back(std::max<Eigen::Index>(1, test.count() / at_most));
        problem.starts.push_back(count);
        count += (test.count() + strides.back() - 1) / strides.back();
    }
    problem.force.resize(count);
    for (std::size_t r = 0; r < tests.size(); ++r) {
        const Eigen::Index n = (tests[r].count() + strides[r] - 1) / strides[r];
        Eigen::VectorXd q(n);
        for (Eigen::Index i = 0; i < n; ++i) {
            q[i] = tests[r].q[i * strides[r]];
            problem.force[problem.starts[r] + i] = tests[r].force[i * strides[r]];
        }
        problem.q.push_back(q);
    }
    return problem;
}

}  // namespace

Eigen::VectorXd simulateFriction(const FrictionGapLaw& law, const Eigen::VectorXd& q) {
    const UnitForces unit = calcUnitForces(law.presliding, law.gap, q);
    return law.positive_level * unit.positive + law.negative_level * unit.negative;
}

double calcRelativeError(const FrictionGapLaw& law, const ComponentData& data) {
    return (simulateFriction(law, data.q) - data.force).norm() / data.force.norm();
}

FrictionGapFit fitFrictionGap(const std::vector<ComponentData>& tests, bool with_gap) {
    double range = 0;
    for (const auto& test : tests) range = std::max(range, test.q.maxCoeff() - test.q.minCoeff());
    const Problem coarse = stack(tests, 2000);
    double presliding = 0, gap = 0, best = std::numeric_limits<double>::infinity();
    const auto consider = [&](const Problem& problem, double s, double g) {
        if (s < 1e-4 * range || g < 0 || s + g > range) return false;
        const double cost = problem.calcCost(s, g);
        if (cost >= best) return false;
        best = cost;
        presliding = s;
        gap = g;
        return true;
    };
    for (int i = 1; i <= 16; ++i)
        for (int j = 0; j <= (with_gap ? 16 : 0); ++j) consider(coarse, 0.4 * range * i / 16, 0.4 * range * j / 16);
    // Compass search: steps halved where no neighbour is better.
    const Problem full = stack(tests, std::numeric_limits<Eigen::Index>::max());
    best = full.calcCost(presliding, gap);
    for (double step = 0.0125 * range; step > 1e-5 * range;) {
        const double s = presliding, g = gap;
        bool moved = consider(full, s + step, g) || consider(full, s - step, g);
        if (with_gap) moved = consider(full, presliding, g + step) || consider(full, presliding, g - step) || moved;
        // Along the valley: the sum of both is what fixes the end of the rise.
        if (with_gap) moved = consider(full, presliding + step, gap - step) || moved;
        if (with_gap) moved = consider(full, presliding - step, gap + step) || moved;
        if (!moved) step *= 0.5;
    }

    const Eigen::MatrixXd X = full.makeColumns(presliding, gap);
    const Eigen::Vector2d levels = full.solveLevels(X);
    FrictionGapFit fit;
    fit.law = {levels[0], levels[1], presliding, gap};
    const Eigen::VectorXd residual = full.force - X * levels;
    fit.relative_error = residual.norm() / full.force.norm();

    const double h = 1e-4 * range;
    Eigen::MatrixXd J(full.force.size(), with_gap ? 4 : 3);
    J.leftCols(2) = X;
    J.col(2) = (full.makeColumns(presliding + h, gap) - full.makeColumns(presliding - h, gap)) * levels / (2 * h);
    if (with_gap)
        J.col(3) = (full.makeColumns(presliding, gap + h) - full.makeColumns(presliding, gap - h)) * levels / (2 * h);
    const Estimates e = solveBlocks(J, residual, full.starts);
    const auto add = [&](const char* name, const char* unit, double value, Eigen::Index k) {
        fit.parameters.push_back({name, value, unit, value - e.calcHalfWidth(k), value + e.calcHalfWidth(k)});
    };
    add("friction level towards +", "N", levels[0], 0);
    add("friction level towards -", "N", -levels[1], 1);
    add("presliding", "m", presliding, 2);
    if (with_gap) add("gap", "m", gap, 3);
    return fit;
}

}  // namespace wems::identify
