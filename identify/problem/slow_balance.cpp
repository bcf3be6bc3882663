#include "identify/problem/slow_balance.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "identify/problem/mount_equation.hpp"
#include "identify/problem/open_loop_run.hpp"
#include "models/axis_law.hpp"
#include "models/bryant.hpp"

namespace wems::identify {
namespace {

constexpr double kCorner = 1.25;   // of the lowest frequency where the motion is known; 0.75 of the lowest excited
constexpr double kBalanced = 1.2;  // of the corner: splines hold 4 % of what is faster
// Of the linear stiffness, holds the motion where the window hides it. At the truth of three rigs chi-squared is the
// same to 0.1 % from 0.0004 to 0.01; 0.05 adds up to 0.13 %, 0.2 up to 0.4 %.
constexpr double kHeld = 0.002;
constexpr int kBalanceIterations = 8;
constexpr int kHalvings = 4;
// Of the relative motion, RMS: P takes off what that leaves, but for its square. On four rigs misfits at the truth were
// within 2e-4 of those with 10 nm.
constexpr double kSettled = 1e-4;

}  // namespace

SlowBalance::SlowBalance(const OpenLoopRun& run, const MountModel& model, Eigen::VectorXd followed)
    : corner_(kCorner * run.lowest), interval_(run.interval), taper_(run.taper), freedom_(calcFreedom(model.body)) {
    const Eigen::Index samples = run.sampleCount();
    splines_ = calcWeights(samples - 1).first + 4;
    followed_ = followed.size() > 0 ? std::move(followed) : Eigen::VectorXd::Zero(6 * splines_);
    // A fixed part that moves slowly takes no inertia force of the mobile one.
    Matrix6 M = run.mobile_integrated ? calcMassMatrix(model.body) : Matrix6::Zero();
    least_ = kHeld * calcStiffnessMatrix(model);
    const double stiffest = calcStiffnessMatrix(model).diagonal().maxCoeff();
    holdMotions(M, freedom_, 0);
    holdMotions(least_, freedom_, kHeld * stiffest);
    findStiffness(run, model, stiffest);
    weights_.reserve(static_cast<std::size_t>(samples));
    for (Eigen::Index k = 0; k < samples; ++k) weights_.push_back(calcWeights(k));
    // Of each pair of splines: the sums of w w, which K at rest multiplies, and those of M and `least_`; and of w w K
    // beyond it.
    std::vector<Matrix6> blocks(4 * splines_, Matrix6::Zero());
    std::vector<double> elastic(blocks.size(), 0.0), inertial(blocks.size(), 0.0);
    held_.assign(blocks.size(), 0.0);
    const auto pairOf = [](const Weights& weights, int i, int j) {
        return 4 * static_cast<std::size_t>(weights.first + i) + static_cast<std::size_t>(i - j);
    };
    // The splines at the ends reach beyond the run: of one that touches it with its last samples nothing else is known.
    const auto beyond = static_cast<Eigen::Index>(std::ceil(3 / (2 * corner_ * interval_)));
    for (Eigen::Index k = -beyond; k < samples + beyond; ++k) {
        const bool inside = k >= 0 && k < samples;
        const Weights weights = inside ? weights_[k] : calcWeights(k);
        const double taper = inside ? taper_[k] : 0;
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j <= i; ++j) {
                if (weights.first + j < 0 || weights.first + i >= splines_) continue;
                const std::size_t pair = pairOf(weights, i, j);
                const double both = weights.value[0][i] * weights.value[0][j];
                elastic[pair] += taper * both;
                // By parts: the splines' second derivatives become products of their first.
                inertial[pair] -= taper * weights.value[1][i] * weights.value[1][j];
                // Where the taper hides all, there is no slow motion.
                held_[pair] += (1 - taper) * both;
            }
    }
    for (const Contact& contact : contacts_) {
        const Weights& weights = weights_[contact.sample];
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j <= i; ++j)
                blocks[pairOf(weights, i, j)] +=
                    taper_[contact.sample] * weights.value[0][i] * weights.value[0][j] * contact.beyond;
    }
    for (std::size_t pair = 0; pair < blocks.size(); ++pair)
        blocks[pair] += elastic[pair] * at_rest_ + inertial[pair] * M + held_[pair] * least_;
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(144 * static_cast<std::size_t>(splines_));
    for (Eigen::Index s = 0; s < splines_; ++s)
        for (Eigen::Index back = 0; back <= std::min<Eigen::Index>(3, s); ++back) {
            const Matrix6& block = blocks[4 * s + back];
            for (int i = 0; i < 6; ++i)
                for (int j = 0; j < 6; ++j)
                    entries.emplace_back(static_cast<int>(6 * s + i), static_cast<int>(6 * (s - back) + j),
                                         block(i, j));
        }
    Eigen::SparseMatrix<double> A(6 * splines_, 6 * splines_);
    A.setFromTriplets(entries.begin(), entries.end());
    factor_.compute(A);
}

/// Most axes are at rest most of the time: a contact adds to what they have there.
/// @param held of motions that the body does not have, N/m
void SlowBalance::findStiffness(const OpenLoopRun& run, const MountModel& model, double held) {
    at_rest_ = Matrix6::Zero();
    std::vector<Vector6> directions;
    std::vector<Eigen::VectorXd> beyond_rest;
    for (std::size_t i = 0; i < model.connections.size(); ++i)
        for (int a = 0; a < 3; ++a) {
            const AxisLaw& law = model.connections[i].axis[a];
            const auto d = calcAxisDirection(model, static_cast<int>(i), a);
            const double rest = AxisForce(law).calcStaticStiffness(0);
            at_rest_ += rest * d * d.transpose();
            directions.push_back(freedom_.cwiseProduct(d));
            beyond_rest.emplace_back(calcTangent(run, law, static_cast<Eigen::Index>(beyond_rest.size())).array() -
                                     rest);
        }
    holdMotions(at_rest_, freedom_, held);
    for (Eigen::Index k = 0; k < run.sampleCount(); ++k) {
        bool touched = false;
        for (std::size_t row = 0; row < beyond_rest.size(); ++row) {
            const double beyond = beyond_rest[row][k];
            if (beyond == 0) continue;
            if (!std::exchange(touched, true)) contacts_.push_back({k, Matrix6::Zero()});
            contacts_.back().beyond += beyond * directions[row] * directions[row].transpose();
        }
    }
}

double SlowBalance::highestBalanced() const {
    return kBalanced * corner_;
}

SlowBalance::Weights SlowBalance::calcWeights(Eigen::Index sample) const {
    const double rate = 2 * corner_, at = static_cast<double>(sample) * interval_ * rate;
    Weights weights{static_cast<Eigen::Index>(std::floor(at)), {}};
    const double u = at - std::floor(at), v = 1 - u;
    const double value[3][4] = {
        {v * v * v / 6, (3 * u * u * u - 6 * u * u + 4) / 6, (3 * v * v * v - 6 * v * v + 4) / 6, u * u * u / 6},
        {-v * v / 2, (3 * u * u - 4 * u) / 2, -(3 * v * v - 4 * v) / 2, u * u / 2},
        {v, 3 * u - 2, 3 * v - 2, u}};
    double scale = 1;
    for (int derivative = 0; derivative < 3; ++derivative, scale *= rate)
        for (int i = 0; i < 4; ++i) weights.value[derivative][i] = scale * value[derivative][i];
    return weights;
}

Eigen::MatrixXd SlowBalance::project(const Eigen::Ref<const Eigen::MatrixXd>& residual) const {
    Matrix6X right = Matrix6X::Zero(6, splines_);
    for (Eigen::Index k = 0; k < residual.cols(); ++k) {
        const Weights& weights = weights_[k];
        const Vector6 tapered = taper_[k] * residual.col(k);
        for (int i = 0; i < 4; ++i) right.col(weights.first + i) += weights.value[0][i] * tapered;
    }
    return freedom_.asDiagonal() * right;
}

Eigen::VectorXd SlowBalance::solve(const Eigen::Ref<const Eigen::MatrixXd>& residual) const {
    return factor_.solve(project(residual).reshaped());
}

Eigen::VectorXd SlowBalance::solveHeld(const Eigen::Ref<const Eigen::MatrixXd>& residual,
                                       const Eigen::Ref<const Eigen::VectorXd>& followed) const {
    const auto c = followed.reshaped(6, splines_);
    Eigen::MatrixXd held = Eigen::MatrixXd::Zero(6, splines_);
    for (Eigen::Index s = 0; s < splines_; ++s)
        for (Eigen::Index back = 0; back <= std::min<Eigen::Index>(3, s); ++back) {
            const double factor = held_[4 * s + back];
            held.col(s) += factor * c.col(s - back);
            if (back > 0) held.col(s - back) += factor * c.col(s);
        }
    const Eigen::MatrixXd right = project(residual) + least_ * held;
    return factor_.solve(right.reshaped());
}

Eigen::MatrixXd SlowBalance::calcMotion(const Eigen::Ref<const Eigen::VectorXd>& coefficients, int derivative) const {
    return sumSplines(coefficients.reshaped(6, splines_), derivative);
}

SlowBalance::Matrix6X SlowBalance::sumSplines(const Matrix6X& c, int derivative) const {
    Matrix6X sum(6, taper_.size());
    for (Eigen::Index k = 0; k < sum.cols(); ++k) {
        const Eigen::Index first = weights_[k].first;
        const double* w = weights_[k].value[derivative];
        sum.col(k) = w[0] * c.col(first) + w[1] * c.col(first + 1) + w[2] * c.col(first + 2) + w[3] * c.col(first + 3);
    }
    return sum;
}

Eigen::MatrixXd SlowBalance::calcForces(const Eigen::Ref<const Eigen::VectorXd>& coefficients) const {
    const auto c = coefficients.reshaped(6, splines_);
    Matrix6X forces = sumSplines(at_rest_ * c, 0);
    for (const Contact& contact : contacts_) {
        const Weights& weights = weights_[contact.sample];
        const Vector6 moved = c.middleCols<4>(weights.first) * Eigen::Map<const Eigen::Vector4d>(weights.value[0]);
        forces.col(contact.sample) += contact.beyond * moved;
    }
    return forces;
}

Eigen::MatrixXd SlowBalance::balance(const Eigen::Ref<const Eigen::MatrixXd>& residual) const {
    return residual - calcForces(solve(residual));
}

std::unique_ptr<SlowBalance> followSlowMotion(OpenLoopRun& run, const MountModel& model) {
    if (!run.integrated() || !(run.lowest > 0)) return nullptr;
    const auto move = [&](const SlowBalance& balance, const Eigen::VectorXd& coefficients) {
        OpenLoopRun moved = run;
        // What was measured stays: the relative motion is the same if the fixed part moves the other way.
        const double sign = run.mobile_integrated ? 1.0 : -1.0;
        auto& part = run.mobile_integrated ? moved.mobile : moved.fixed;
        const Eigen::MatrixXd x = sign * balance.calcMotion(coefficients, 0),
                              v = sign * balance.calcMotion(coefficients, 1),
                              a = sign * balance.calcMotion(coefficients, 2);
        part.p += x.topRows(3);
        part.theta += x.bottomRows(3);
        part.v += v.topRows(3);
        part.w += v.bottomRows(3);
        part.a += a.topRows(3);
        part.alpha += a.bottomRows(3);
        for (Eigen::Index k = 0; k < part.theta.cols(); ++k) part.R[k] = rotationFromVector(part.theta.col(k));
        calcRelative(model, moved.mobile, moved.fixed, moved.q, moved.v);
        moved.quiet.add(moved.v - run.v);
        return moved;
    };
    auto balance = std::make_unique<SlowBalance>(run, model);
    // As the window sees it.
    const auto size = [&](const Eigen::VectorXd& coefficients) {
        const Eigen::MatrixXd motion = balance->calcMotion(coefficients, 0);
        return std::sqrt(motion.colwise().squaredNorm().dot(run.taper) / run.taper.sum());
    };
    const double settled = kSettled * run.q.norm() / std::sqrt(static_cast<double>(run.q.size()));
    Eigen::VectorXd step = -balance->solve(calcMountResidual(run, model));
    for (int iteration = 0; iteration < kBalanceIterations && size(step) > settled; ++iteration) {
        bool moved_closer = false;
        double share = 1;
        for (int halving = 0; halving < kHalvings && !moved_closer; ++halving, share *= 0.5) {
            OpenLoopRun moved = move(*balance, share * step);
            const Eigen::MatrixXd residual = calcMountResidual(moved, model);
            const Eigen::VectorXd followed = balance->followed() + share * step;
            // What the same tangents would have to move further: it must be less than before.
            moved_closer = size(balance->solveHeld(residual, followed)) < size(step);
            if (!moved_closer) continue;
            run = std::move(moved);
            balance = std::make_unique<SlowBalance>(run, model, followed);
            step = -balance->solveHeld(residual, followed);
        }
        if (!moved_closer) break;
    }
    return balance;
}

}  // namespace wems::identify
