#include "identify/diagnose/screening.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "identify/motion/parallel.hpp"

namespace wems::identify {
namespace {

/// A trial value is not trusted further than this along its way where the effect is not linear.
constexpr double kFarthest = 1.5;

Screened screenStart(const OpenLoopProblem& problem, const LawDifferences& laws, const MountModel& model,
                     const WhiteVector& residual, const Candidate& candidate, const std::vector<double>& start) {
    const auto calcDifference = [&](const MountModel& changed) {
        return OpenLoopProblem::differInLawsAlone(model, changed) ? laws.calc(model, changed)
                                                                  : problem.calcDifference(model, changed);
    };
    const double variance = problem.calcVariance(residual);
    Screened result;
    result.values = start;
    if (candidate.knobs.empty() || candidate.linear == 0) {
        MountModel changed = model;
        candidate.apply(changed, start);
        const auto d = calcDifference(changed);
        result.gain = -2 * problem.product(residual, d, variance) - problem.product(d, d, variance);
        return result;
    }
    std::vector<double> present;
    for (const auto& knob : candidate.knobs) present.push_back(knob.get(model));
    const Eigen::Index count = candidate.linear;
    std::vector<double> values = start;
    for (std::size_t i = 0; i < candidate.linear; ++i) values[i] = present[i];
    std::vector<WhiteVector> columns;
    Eigen::MatrixXd normal(count, count);
    Eigen::VectorXd right(count);
    for (Eigen::Index i = 0; i < count; ++i) {
        auto moved = values;
        moved[i] = start[i];
        MountModel changed = model;
        candidate.apply(changed, moved);
        columns.push_back(calcDifference(changed));
        right[i] = -problem.product(columns.back(), residual, variance);
        for (Eigen::Index j = 0; j <= i; ++j)
            normal(i, j) = normal(j, i) = problem.product(columns.back(), columns[j], variance);
    }
    if (!(normal.diagonal().minCoeff() > 0)) {
        // A knob without effect: nothing can be said about it; the others may still count.
        normal.diagonal().array() += 1e-9 * normal.diagonal().maxCoeff() + 1e-30;
    }
    Eigen::VectorXd way = normal.ldlt().solve(right);
    const bool nonlinear = candidate.starts.size() > 1 && candidate.linear == candidate.knobs.size();
    for (Eigen::Index i = 0; i < count; ++i) {
        const std::size_t s = i;
        const auto& knob = candidate.knobs[s];
        if (nonlinear && i == 0) way[i] = std::clamp(way[i], 0.0, kFarthest);
        const double wanted = present[s] + way[i] * (start[s] - present[s]);
        result.values[s] = std::clamp(wanted, knob.lowest(model), knob.highest(model));
        way[i] = (result.values[s] - present[s]) / (start[s] - present[s]);
    }
    result.gain = 2 * way.dot(right) - way.dot(normal * way);
    return result;
}

}  // namespace

std::vector<Screened> screenCandidates(const OpenLoopProblem& problem, LawDifferences& laws, const MountModel& model,
                                       const WhiteVector& residual, const std::vector<Candidate>& candidates,
                                       double price) {
    laws.keepOnly(model);
    std::vector<Screened> results(candidates.size());
    runParallel(candidates.size(), [&](std::size_t i) {
        results[i].candidate = i;
        results[i].gain = -1;
        for (const auto& start : candidates[i].starts) {
            auto screened = screenStart(problem, laws, model, residual, candidates[i], start);
            if (!std::isfinite(screened.gain) || screened.gain <= results[i].gain) continue;
            screened.candidate = i;
            results[i] = screened;
        }
    });
    const auto worth = [&](const Screened& s) {
        return s.gain - price * static_cast<double>(candidates[s.candidate].knobs.size());
    };
    std::sort(results.begin(), results.end(),
              [&](const Screened& a, const Screened& b) { return worth(a) > worth(b); });
    return results;
}

}  // namespace wems::identify
