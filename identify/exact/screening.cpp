#include "identify/exact/screening.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>

#include "identify/motion/parallel.hpp"
#include "identify/problem/mount_equation.hpp"
#include "models/law_equality.hpp"

namespace wems::identify {

namespace {

const AxisLaw& lawOf(const MountModel& model, std::size_t axis) {
    return model.connections[axis / 3].axis[axis % 3];
}

/// Complex values of a column of whitened values: 6 x bins.
Eigen::MatrixXcf asComplex(const Eigen::Ref<const Eigen::VectorXf>& values) {
    Eigen::MatrixXcf result(6, values.size() / 12);
    for (Eigen::Index b = 0; b < result.cols(); ++b)
        for (int i = 0; i < 6; ++i) result(i, b) = {values[12 * b + i], values[12 * b + 6 + i]};
    return result;
}

}  // namespace

LawDifferences::LawDifferences(const OpenLoopProblem& problem, const MountModel& model)
    : problem_(&problem), axes_(3 * model.connections.size()) {
    const auto& columns = problem.calibrationColumns();
    for (std::size_t r = 0; r < problem.runs().size(); ++r) {
        const Whitening& whitening = problem.whitening(r);
        std::vector<Eigen::MatrixXcf> faults;
        for (Eigen::Index c = 0; c < columns.cols(); ++c)
            faults.push_back(asComplex(columns.col(c).segment(problem.offset(r), whitening.mountSize())));
        for (std::size_t a = 0; a < axes_.size(); ++a) {
            const auto direction = calcAxisDirection(model, static_cast<int>(a / 3), static_cast<int>(a % 3));
            Eigen::MatrixXcf white = whitening.whitenDirection(Equation::mount, direction);
            Eigen::MatrixXcf products(columns.cols(), white.cols());
            for (Eigen::Index c = 0; c < columns.cols(); ++c)
                products.row(c) = white.conjugate().cwiseProduct(faults[c]).colwise().sum();
            axes_[a].white.push_back(std::move(white));
            axes_[a].calibration.push_back(std::move(products));
        }
    }
    for (std::size_t a = 0; a < axes_.size(); ++a) {
        axes_[a].present = lawOf(model, a);
        axes_[a].present_force.resize(problem.runs().size());
    }
    keepOnly(model);
}

void LawDifferences::keepOnly(const MountModel& model) {
    for (std::size_t a = 0; a < axes_.size(); ++a) {
        Axis& axis = axes_[a];
        const AxisLaw& law = lawOf(model, a);
        if (axis.present == law && axis.present_force.front().size() > 0) continue;
        axis.present = law;
        axis.known.clear();
        for (std::size_t r = 0; r < axis.present_force.size(); ++r)
            axis.present_force[r] =
                calcAxisForce(problem_->runs()[r], law, static_cast<int>(a / 3), static_cast<int>(a % 3));
    }
}

std::shared_ptr<const LawDifferences::Change> LawDifferences::make(std::size_t axis, const AxisLaw& from,
                                                                   const AxisLaw& to) const {
    const Axis& own = axes_[axis];
    const auto connection = static_cast<int>(axis / 3), a = static_cast<int>(axis % 3);
    auto change = std::make_shared<Change>();
    change->from = from;
    change->to = to;
    change->calibration = Eigen::VectorXd::Zero(problem_->calibrationColumns().cols());
    change->slow.resize(problem_->runs().size());
    for (std::size_t r = 0; r < problem_->runs().size(); ++r) {
        const auto& run = problem_->runs()[r];
        const Eigen::VectorXd before =
            from == own.present ? own.present_force[r] : calcAxisForce(run, from, connection, a);
        const Eigen::VectorXd force = calcAxisForce(run, to, connection, a) - before;
        change->spectra.emplace_back();
        if (force.isZero(0.0)) continue;  // such as a stop that is not reached
        const Whitening& whitening = problem_->whitening(r);
        change->spectra.back() = whitening.calcSpectrum(force);
        if (const auto* balance = whitening.slowBalance())
            change->slow[r] = balance->solve(force, calcAxisDirection(problem_->reference(), connection, a));
        change->calibration += (own.calibration[r].conjugate() * change->spectra.back()).real().cast<double>();
    }
    return change;
}

std::shared_ptr<const LawDifferences::Change> LawDifferences::find(std::size_t axis, const AxisLaw& from,
                                                                   const AxisLaw& to) const {
    const auto search = [&]() -> std::shared_ptr<const Change> {
        const std::lock_guard<std::mutex> lock(mutex_);
        const auto& known = axes_[axis].known;
        const auto found = std::find_if(known.begin(), known.end(),
                                        [&](const auto& change) { return change->to == to && change->from == from; });
        return found == known.end() ? nullptr : *found;
    };
    if (auto known = search()) return known;
    // Two threads may compute the same change at the same time, which costs time and nothing else.
    auto change = make(axis, from, to);
    const std::lock_guard<std::mutex> lock(mutex_);
    axes_[axis].known.push_back(change);
    return change;
}

WhiteVector LawDifferences::calc(const MountModel& from, const MountModel& to) const {
    WhiteVector result;
    std::vector<Eigen::VectorXd> slow(problem_->runs().size());
    for (std::size_t a = 0; a < axes_.size(); ++a) {
        const AxisLaw &before = lawOf(from, a), &after = lawOf(to, a);
        if (before == after) continue;
        const auto change = find(a, before, after);
        for (std::size_t r = 0; r < change->spectra.size(); ++r) {
            const auto& spectrum = change->spectra[r];
            if (spectrum.size() == 0) continue;
            if (result.isZero()) {
                result.values = Eigen::VectorXf::Zero(problem_->size());
                result.calibration = Eigen::VectorXd::Zero(change->calibration.size());
            }
            addAlong(axes_[a].white[r], spectrum,
                     result.values.segment(problem_->offset(r), problem_->whitening(r).mountSize()));
            if (change->slow[r].size() == 0) continue;
            if (slow[r].size() == 0) slow[r] = Eigen::VectorXd::Zero(change->slow[r].size());
            slow[r] += change->slow[r];
        }
        if (!result.isZero()) result.calibration += change->calibration;
    }
    for (std::size_t r = 0; r < slow.size(); ++r) {
        if (slow[r].size() == 0) continue;
        const Whitening& whitening = problem_->whitening(r);
        Eigen::VectorXf values(whitening.mountSize());
        whitening.applySlow(slow[r], values);
        result.values.segment(problem_->offset(r), values.size()) -= values;
        result.calibration -=
            (problem_->calibrationColumns().middleRows(problem_->offset(r), values.size()).transpose() * values)
                .cast<double>();
    }
    return result;
}

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
