#include "identify/diagnose/parameter_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace wems::identify {
namespace {

constexpr double kStep = 1e-3;      // of a knob's scale, for finite differences
constexpr double kRelative = 1e-5;  // of the misfit: smaller gains end the fit
constexpr double kAbsolute = 0.05;  // of the sum of squares

struct Linearised {
    Eigen::MatrixXd normal;
    Eigen::VectorXd gradient, scale;
};

Linearised linearise(const OpenLoopProblem& problem, const ParameterFit& at, const std::vector<Knob>& knobs) {
    const Eigen::Index count = knobs.size();
    Linearised result{Eigen::MatrixXd::Zero(count, count), Eigen::VectorXd::Zero(count), Eigen::VectorXd(count)};
    const double variance = problem.calcVariance(at.residual);
    std::vector<WhiteVector> columns;
    for (Eigen::Index i = 0; i < count; ++i) {
        const auto& knob = knobs[i];
        result.scale[i] = knob.scale(at.model);
        double step = kStep * result.scale[i];
        const double value = at.values[i];
        if (value + step > knob.highest(at.model)) step = -step;
        MountModel moved = at.model;
        knob.set(moved, value + step);
        columns.push_back(problem.calcDifference(at.model, moved));
        auto& column = columns.back();
        const double factor = result.scale[i] / step;
        if (!column.isZero()) {
            column.values *= static_cast<float>(factor);
            column.calibration *= factor;
        }
        result.gradient[i] = problem.product(column, at.residual, variance);
        for (Eigen::Index j = 0; j <= i; ++j)
            result.normal(i, j) = result.normal(j, i) = problem.product(column, columns[j], variance);
    }
    return result;
}

}  // namespace

ParameterFit fitParameters(const OpenLoopProblem& problem, const MountModel& start, const std::vector<Knob>& knobs,
                           int max_iterations) {
    ParameterFit fit;
    fit.model = start;
    for (const auto& knob : knobs) fit.values.push_back(knob.get(start));
    fit.residual = problem.calcResidual(start);
    fit.misfit = problem.calcMisfit(fit.residual);
    const Eigen::Index count = knobs.size();
    fit.covariance = Eigen::MatrixXd::Zero(count, count);
    if (count == 0) return fit;
    const double absolute = kAbsolute / static_cast<double>(problem.size());
    double damping = 1e-6;
    Linearised linear = linearise(problem, fit, knobs);
    for (fit.iterations = 0; fit.iterations < max_iterations; ++fit.iterations) {
        Eigen::MatrixXd normal = linear.normal;
        const double floor = 1e-12 * normal.diagonal().maxCoeff() + 1e-300;
        normal.diagonal() += damping * normal.diagonal() + Eigen::VectorXd::Constant(count, floor);
        const Eigen::VectorXd step = -normal.ldlt().solve(linear.gradient);
        ParameterFit next;
        next.model = fit.model;
        for (Eigen::Index i = 0; i < count; ++i) {
            const auto& knob = knobs[i];
            const double wanted = fit.values[i] + step[i] * linear.scale[i];
            next.values.push_back(std::clamp(wanted, knob.lowest(fit.model), knob.highest(fit.model)));
            knob.set(next.model, next.values.back());
        }
        next.residual = problem.calcResidual(next.model);
        next.misfit = problem.calcMisfit(next.residual);
        const double gain = fit.misfit - next.misfit;
        if (!(gain > 0)) {
            damping = std::max(damping * 30, 1e-3);
            if (damping > 1e4 || gain > -absolute) break;
            continue;
        }
        fit.model = next.model;
        fit.values = next.values;
        fit.residual = std::move(next.residual);
        fit.misfit = next.misfit;
        damping = std::max(damping * 0.1, 1e-9);
        linear = linearise(problem, fit, knobs);
        if (gain < absolute + kRelative * fit.misfit) break;
    }
    Eigen::MatrixXd normal = linear.normal;
    normal.diagonal().array() += 1e-14 * normal.diagonal().maxCoeff() + 1e-300;
    fit.covariance = linear.scale.asDiagonal() * normal.inverse() * linear.scale.asDiagonal();
    return fit;
}

}  // namespace wems::identify
