#include "models/periodic/harmonic_balance.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "models/pi.hpp"

namespace wems {
namespace {

using Complex = std::complex<double>;

/// Rows: times 2π (k + shift)/count; columns: 1, cos, sin.
void fillBasis(int harmonics, Eigen::Index count, double shift, Eigen::MatrixXd& basis, Eigen::MatrixXd& slope) {
    basis = Eigen::MatrixXd::Zero(count, 2 * harmonics + 1);
    slope = basis;
    basis.col(0).setOnes();
    for (Eigen::Index row = 0; row < count; ++row) {
        const double angle = kTwoPi * (static_cast<double>(row) + shift) / static_cast<double>(count);
        for (int k = 1; k <= harmonics; ++k) {
            basis(row, k) = std::cos(k * angle);
            basis(row, harmonics + k) = std::sin(k * angle);
            slope(row, k) = -k * std::sin(k * angle);
            slope(row, harmonics + k) = k * std::cos(k * angle);
        }
    }
}

}  // namespace

HarmonicBalance::HarmonicBalance(const PeriodicSystem& system, int harmonics)
    : system_(system), harmonics_(harmonics), axes_(system.axes().size()), coefficients_(2 * harmonics + 1) {
    // Kinks of stops spread over all harmonics: so many times of a period keep small what folds back.
    constexpr int samples_per_harmonic = 24, fewest = 256;
    const Eigen::Index count = std::max(fewest, samples_per_harmonic * harmonics);
    fillBasis(harmonics, count, 0, basis_, slope_basis_);
    projection_ = 2.0 / static_cast<double>(count) * basis_.transpose();
    projection_.row(0) /= 2;
}

HarmonicBalance::Linear HarmonicBalance::calcLinear(double frequency) const {
    Linear linear;
    linear.frequency = frequency;
    const Eigen::MatrixXd& J = system_.rows();
    for (int k = 0; k <= harmonics_; ++k) {
        if (k == 0) {
            // A coordinate that nothing holds stays where it is.
            const Eigen::MatrixXd flexible =
                J * system_.linear().stiffness.completeOrthogonalDecomposition().solve(J.transpose());
            linear.flexible.push_back(flexible.cast<Complex>());
            continue;
        }
        const Eigen::PartialPivLU<Eigen::MatrixXcd> D(calcDynamicStiffness(system_.linear(), kTwoPi * frequency * k));
        linear.flexible.push_back(J.cast<Complex>() * D.solve(J.transpose().cast<Complex>()));
        if (k == 1) linear.excited = J.cast<Complex>() * D.solve(system_.calcForce(frequency).cast<Complex>());
    }
    return linear;
}

HarmonicBalance::Nonlinear HarmonicBalance::calcNonlinear(const Eigen::VectorXd& Q, double frequency) const {
    const double omega = kTwoPi * frequency;
    Nonlinear nonlinear;
    nonlinear.force = Eigen::VectorXd::Zero(unknowns());
    nonlinear.slope.resize(axes_);
    Eigen::VectorXd n(samples()), stiffness(samples()), damping(samples());
    for (Eigen::Index a = 0; a < axes_; ++a) {
        const auto own = Q.segment(a * coefficients_, coefficients_);
        const Eigen::VectorXd q = basis_ * own, v = omega * (slope_basis_ * own);
        for (Eigen::Index i = 0; i < samples(); ++i) {
            const NonlinearAxis::Value value = system_.axes()[a].calcValue(q[i], v[i], halfCell(frequency));
            n[i] = value.force;
            stiffness[i] = value.stiffness;
            damping[i] = value.damping;
        }
        // What is left of a law without its nonlinear part is rounding of its stiffness.
        const double rounding = 1e-9 * (1 + system_.linear().stiffness.cwiseAbs().maxCoeff());
        if (stiffness.cwiseAbs().maxCoeff() <= rounding && damping.cwiseAbs().maxCoeff() * omega <= rounding) continue;
        nonlinear.force.segment(a * coefficients_, coefficients_) = projection_ * n;
        Eigen::MatrixXd weighted = stiffness.asDiagonal() * basis_;
        weighted += omega * (damping.asDiagonal() * slope_basis_);
        nonlinear.slope[a] = projection_ * weighted;
    }
    return nonlinear;
}

Eigen::VectorXd HarmonicBalance::applyFlexibility(const Linear& linear, const Eigen::VectorXd& N) const {
    Eigen::VectorXd Q(unknowns());
    for (int k = 0; k <= harmonics_; ++k) {
        Eigen::VectorXcd force(axes_);
        for (Eigen::Index a = 0; a < axes_; ++a)
            force[a] = {N[a * coefficients_ + k], k > 0 ? -N[a * coefficients_ + harmonics_ + k] : 0};
        const Eigen::VectorXcd motion = linear.flexible[k] * force;
        for (Eigen::Index a = 0; a < axes_; ++a) {
            Q[a * coefficients_ + k] = motion[a].real();
            if (k > 0) Q[a * coefficients_ + harmonics_ + k] = -motion[a].imag();
        }
    }
    return Q;
}

Eigen::VectorXd HarmonicBalance::calcLinearMotion(const Linear& linear) const {
    Eigen::VectorXd Q = Eigen::VectorXd::Zero(unknowns());
    for (Eigen::Index a = 0; a < axes_; ++a) {
        Q[a * coefficients_ + 1] = linear.excited[a].real();
        Q[a * coefficients_ + harmonics_ + 1] = -linear.excited[a].imag();
    }
    return Q;
}

Eigen::VectorXd HarmonicBalance::calcResidual(const Linear& linear, const Nonlinear& nonlinear,
                                              const Eigen::VectorXd& Q) const {
    return Q + applyFlexibility(linear, nonlinear.force) - calcLinearMotion(linear);
}

Eigen::MatrixXd HarmonicBalance::calcSlopeColumns(const Linear& linear, const Nonlinear& nonlinear,
                                                  Eigen::Index axis) const {
    const Eigen::MatrixXd& slope = nonlinear.slope[axis];
    Eigen::MatrixXd columns(unknowns(), coefficients_);
    for (int k = 0; k <= harmonics_; ++k)
        for (Eigen::Index a = 0; a < axes_; ++a) {
            const Complex g = linear.flexible[k](a, axis);
            const Eigen::Index row = a * coefficients_ + k;
            if (k == 0) {
                columns.row(row) = g.real() * slope.row(0);
                continue;
            }
            // (g_r + i g_i)(n_c − i n_s)
            columns.row(row) = g.real() * slope.row(k) + g.imag() * slope.row(harmonics_ + k);
            columns.row(row + harmonics_) = g.real() * slope.row(harmonics_ + k) - g.imag() * slope.row(k);
        }
    return columns;
}

Eigen::MatrixXcd HarmonicBalance::calcMotion(const Eigen::VectorXd& Q, double frequency) const {
    const Nonlinear nonlinear = calcNonlinear(Q, frequency);
    const Eigen::MatrixXd& J = system_.rows();
    Eigen::MatrixXcd motion(J.cols(), harmonics_ + 1);
    for (int k = 0; k <= harmonics_; ++k) {
        Eigen::VectorXcd force = Eigen::VectorXcd::Zero(J.cols());
        if (k == 1) force = system_.calcForce(frequency).cast<Complex>();
        for (Eigen::Index a = 0; a < axes_; ++a) {
            const Complex n(nonlinear.force[a * coefficients_ + k],
                            k > 0 ? -nonlinear.force[a * coefficients_ + harmonics_ + k] : 0);
            force -= n * J.row(a).transpose().cast<Complex>();
        }
        if (k == 0) {
            motion.col(0) = system_.linear()
                                .stiffness.completeOrthogonalDecomposition()
                                .solve(Eigen::VectorXd(force.real()))
                                .cast<Complex>();
        } else {
            motion.col(k) = calcDynamicStiffness(system_.linear(), kTwoPi * frequency * k).partialPivLu().solve(force);
        }
    }
    return motion;
}

HarmonicBalance::History HarmonicBalance::calcHistory(const Eigen::VectorXd& Q, double frequency, Eigen::Index axis,
                                                      double shift) const {
    const auto own = Q.segment(axis * coefficients_, coefficients_);
    if (shift == 0) return {basis_ * own, kTwoPi * frequency * (slope_basis_ * own)};
    Eigen::MatrixXd basis, slope;
    fillBasis(harmonics_, samples(), shift, basis, slope);
    return {basis * own, kTwoPi * frequency * (slope * own)};
}

}  // namespace wems
