#include "identify/diagnose/law_differences.hpp"

#include <algorithm>
#include <complex>

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

}  // namespace wems::identify
