#include "models/periodic/floquet.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "models/pi.hpp"

namespace wems {
namespace {

/// One step of the implicit midpoint rule for many disturbances at once. With v_m the mean velocity of the step and
/// a = h/2τ for each branch (its stiffness g acting on q − z):
///
///     [2M + hC + h²/2 (K + Σ g/(1+a) JᵀJ)] v_m = 2M v − h (K x + Σ g/(1+a) Jᵀ(J x − z))
///     v⁺ = 2 v_m − v,   x⁺ = x + h v_m,   z⁺ = 2 z_m − z,   z_m = (z + a J (x + h v_m/2))/(1 + a)
class Midpoint {
public:
    Midpoint(const LinearSystem& system, double step) : system_(system), step_(step) {
        const Eigen::Index states = system.branches.size();
        branch_rows_.resize(states, system.mass.rows());
        weight_.resize(states);
        ratio_.resize(states);
        for (Eigen::Index s = 0; s < states; ++s) {
            const LinearBranch& b = system.branches[s];
            branch_rows_.row(s) = system.ends[b.connection].row(b.axis);
            ratio_[s] = step / (2 * b.branch.time_constant);
            weight_[s] = b.branch.stiffness / (1 + ratio_[s]);
        }
        branch_stiffness_ = branch_rows_.transpose() * weight_.asDiagonal() * branch_rows_;
        setStops(Eigen::MatrixXd::Zero(system.mass.rows(), system.mass.rows()),
                 Eigen::MatrixXd::Zero(system.mass.rows(), system.mass.rows()));
    }

    /// What acts beside the linear system from now on.
    void setStops(const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& damping) {
        stiffness_ = system_.stiffness + stiffness;
        matrix_.compute(2 * system_.mass + step_ * (system_.damping + damping) +
                        0.5 * step_ * step_ * (stiffness_ + branch_stiffness_));
    }

    void advance(Eigen::MatrixXd& x, Eigen::MatrixXd& v, Eigen::MatrixXd& z) const {
        const bool branches = z.rows() > 0;
        Eigen::MatrixXd right = 2 * system_.mass * v - step_ * (stiffness_ * x);
        if (branches) right -= step_ * (branch_rows_.transpose() * (weight_.asDiagonal() * (branch_rows_ * x - z)));
        const Eigen::MatrixXd mean = matrix_.solve(right);
        if (branches) {
            const Eigen::MatrixXd q = branch_rows_ * (x + 0.5 * step_ * mean);
            const Eigen::ArrayXd share = (1 + ratio_.array()).inverse();
            z = 2 * (share.matrix().asDiagonal() * (z + ratio_.asDiagonal() * q)) - z;
        }
        x += step_ * mean;
        v = 2 * mean - v;
    }

private:
    const LinearSystem& system_;
    double step_;
    Eigen::MatrixXd branch_rows_, branch_stiffness_, stiffness_;
    Eigen::VectorXd weight_, ratio_;
    Eigen::PartialPivLU<Eigen::MatrixXd> matrix_;
};

}  // namespace

Eigen::VectorXcd calcFloquetMultipliers(const HarmonicBalance& balance, const Eigen::VectorXd& Q, double frequency) {
    const PeriodicSystem& system = balance.system();
    const Eigen::MatrixXd& J = system.rows();
    const Eigen::Index count = balance.samples(), axes = J.rows(), n = J.cols();
    Eigen::MatrixXd stiffness(axes, count), damping(axes, count);  // at the middle of each step
    for (Eigen::Index a = 0; a < axes; ++a) {
        const HarmonicBalance::History history = balance.calcHistory(Q, frequency, a, 0.5);
        for (Eigen::Index i = 0; i < count; ++i) {
            const auto value = system.axes()[a].calcValue(history.q[i], history.v[i], balance.halfCell(frequency));
            stiffness(a, i) = value.stiffness;
            damping(a, i) = value.damping;
        }
    }
    const Eigen::Index states = system.linear().branches.size();
    const Eigen::Index size = 2 * n + states;
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(n, size), v = x, z = Eigen::MatrixXd::Zero(states, size);
    x.leftCols(n).setIdentity();
    v.middleCols(n, n).setIdentity();
    z.rightCols(states).setIdentity();
    Midpoint midpoint(system.linear(), 1 / (frequency * static_cast<double>(count)));
    Eigen::VectorXd last = Eigen::VectorXd::Zero(2 * axes), now(2 * axes);
    const double rounding = 1e-9 * system.linear().stiffness.cwiseAbs().maxCoeff();
    for (Eigen::Index i = 0; i < count; ++i) {
        now << stiffness.col(i), damping.col(i);
        if ((now - last).cwiseAbs().maxCoeff() > rounding) {
            midpoint.setStops(J.transpose() * stiffness.col(i).asDiagonal() * J,
                              J.transpose() * damping.col(i).asDiagonal() * J);
            last = now;
        }
        midpoint.advance(x, v, z);
    }
    // Balanced: velocities in units of the motion's frequency.
    const double unit = kTwoPi * frequency;
    Eigen::MatrixXd map(size, size);
    map << x, v / unit, z;
    map.middleCols(n, n) *= unit;
    Eigen::VectorXcd multipliers = map.eigenvalues();
    std::sort(multipliers.begin(), multipliers.end(),
              [](const auto& a, const auto& b) { return std::abs(a) > std::abs(b); });
    return multipliers;
}

Instability findInstability(const Eigen::VectorXcd& multipliers) {
    // Coordinates that nothing holds keep their disturbance: multipliers 1 within rounding are no instability.
    constexpr double neutral = 1e-5;
    if (!(std::abs(multipliers[0]) > 1 + neutral)) return Instability::none;
    constexpr double real = 1e-6;
    if (std::abs(multipliers[0].imag()) > real) return Instability::neimark_sacker;
    return multipliers[0].real() > 0 ? Instability::real : Instability::period_doubling;
}

}  // namespace wems
