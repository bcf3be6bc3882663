#include "models/periodic/harmonic_balance.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "models/common/error.hpp"
#include "models/common/units.hpp"
#include "models/mount_forces.hpp"
#include "models/static_equilibrium.hpp"

namespace wems {

namespace {

bool isNonlinear(const AxisLaw& law) {
    return !law.stops.empty() || law.quadratic != 0 || law.cubic != 0 || !law.curve.empty() ||
           (law.friction && law.friction->force > 0);
}

}  // namespace

NonlinearAxis::NonlinearAxis(int connection, int axis, const AxisForce& force, double rest)
    : connection_(connection), axis_(axis), force_(force), rest_(rest) {
    const std::array<double, kMostStates> relaxed = [&] {
        std::array<double, kMostStates> z{};
        z.fill(rest);
        return z;
    }();
    rest_force_ = force.calcStaticForce(rest);
    stiffness_ = force.calcStaticStiffness(rest);
    damping_ = force.calcDamping(rest, 0, 0, relaxed.data());
    for (const MaxwellBranch& branch : force.branches()) branches_ += branch.stiffness;
}

NonlinearAxis::Value NonlinearAxis::calcValue(double q, double v, double half) const {
    // Branches whose dashpots follow q carry nothing: they belong to the linear part.
    std::array<double, kMostStates> relaxed{};
    relaxed.fill(rest_ + q);
    const double* z = relaxed.data();
    Value value{force_.calcForce(rest_ + q, v, 0, z) - rest_force_ - stiffness_ * q - damping_ * v,
                force_.calcStiffness(rest_ + q, v, 0, z) - branches_ - stiffness_,
                force_.calcDamping(rest_ + q, v, 0, z) - damping_};
    const double w = std::abs(v) * half;
    for (const Stop& stop : force_.law().stops) {
        const double direction = stop.side == Side::positive ? 1 : -1;
        const double depth = direction * (rest_ + q + force_.law().offset) - stop.clearance;
        if (!(std::abs(depth) < w)) continue;
        // What the mean has beyond max(0, depth), and its derivatives by depth and w.
        const double beyond = (depth + w) * (depth + w) / (4 * w) - std::max(0.0, depth);
        const double by_depth = (depth + w) / (2 * w) - (depth > 0 ? 1 : 0);
        const double by_w = (depth + w) * (w - depth) / (4 * w * w);
        const double factor = 1 + stop.dissipation * direction * v;
        const double k = direction * stop.stiffness * std::max(0.0, factor);
        value.force += k * beyond;
        value.stiffness += k * direction * by_depth;
        value.damping += k * by_w * half * (v < 0 ? -1 : 1);
        if (factor > 0) value.damping += stop.stiffness * stop.dissipation * beyond;
    }
    return value;
}

PeriodicSystem::PeriodicSystem(const MountModel& model, const HarmonicInput& input)
    : model_(model), input_(input), linear_(linearizeExactly(model)), rest_(findStaticSag(model).relative) {
    const MountForces laws(model);
    for (int i = 0; i < laws.connectionCount(); ++i)
        for (int k = 0; k < 3; ++k) {
            const AxisForce& force = laws.axis(i, k);
            const std::string place = "connection[" + std::to_string(i) + "]." + "xyz"[k];
            if (force.shape().bristle)
                throw InputError({"", 0, place + ".friction"},
                                 "has presliding, whose force depends on all that went before",
                                 "friction without presliding_stiffness, or a simulation in time");
            if (force.shape().hystereses > 0)
                throw InputError({"", 0, place + (force.law().hysteresis ? ".hysteresis" : ".sliders")},
                                 "its force depends on all that went before",
                                 "a law without it, or a simulation in time");
            if (isNonlinear(force.law())) axes_.emplace_back(i, k, force, rest_(k, i));
        }
    // A linear model is answered by the same methods: one axis, which adds nothing.
    if (axes_.empty()) axes_.emplace_back(0, 2, laws.axis(0, 2), rest_(2, 0));
    rows_.resize(axes_.size(), linear_.mass.rows());
    for (std::size_t a = 0; a < axes_.size(); ++a)
        rows_.row(a) = linear_.ends[axes_[a].connection()].row(axes_[a].axis());
}

Eigen::VectorXd PeriodicSystem::calcForce(double frequency) const {
    Eigen::Vector3d load = input_.load;
    if (model_.load) load = calcLoadGains(*model_.load, frequency).cwiseProduct(load);
    return linear_.load * load + linear_.base * input_.base;
}

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
    fillBasis(harmonics, count, 0.5, middle_basis_, middle_slope_basis_);
    projection_ = 2.0 / static_cast<double>(count) * basis_.transpose();
    projection_.row(0) /= 2;
    Eigen::MatrixXd twice, unused;
    fillBasis(2 * harmonics, count, 0, twice, unused);
    moments_ = 1 / static_cast<double>(count) * twice.transpose();
}

Eigen::MatrixXd HarmonicBalance::projectProduct(const Eigen::VectorXd& factor) const {
    const Eigen::VectorXd moments = moments_ * factor;
    const auto cosine = [&](int m) { return moments[std::abs(m)]; };
    const auto sine = [&](int m) { return m == 0 ? 0.0 : (m < 0 ? -1 : 1) * moments[2 * harmonics_ + std::abs(m)]; };
    Eigen::MatrixXd product(coefficients_, coefficients_);
    for (int k = 0; k <= harmonics_; ++k)
        for (int j = 0; j <= harmonics_; ++j) {
            const double mean = j == 0 ? 0.5 : 1;
            product(j, k) = mean * (k == 0 ? 2 * cosine(j) : cosine(j - k) + cosine(j + k));
            if (k > 0) product(j, harmonics_ + k) = mean * (sine(j + k) + sine(k - j));
            if (j > 0) product(harmonics_ + j, k) = k == 0 ? 2 * sine(j) : sine(j + k) + sine(j - k);
            if (j > 0 && k > 0) product(harmonics_ + j, harmonics_ + k) = cosine(j - k) - cosine(j + k);
        }
    return product;
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
        nonlinear.slope[a] = projectProduct(stiffness);
        if (damping.isZero(0)) continue;
        // The velocity of c cos kωt + s sin kωt is kω s cos kωt − kω c sin kωt.
        const Eigen::MatrixXd by_velocity = projectProduct(damping);
        for (int k = 1; k <= harmonics_; ++k) {
            nonlinear.slope[a].col(k) -= k * omega * by_velocity.col(harmonics_ + k);
            nonlinear.slope[a].col(harmonics_ + k) += k * omega * by_velocity.col(k);
        }
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

HarmonicBalance::History HarmonicBalance::calcMiddleHistory(const Eigen::VectorXd& Q, double frequency,
                                                            Eigen::Index axis) const {
    const auto own = Q.segment(axis * coefficients_, coefficients_);
    return {middle_basis_ * own, kTwoPi * frequency * (middle_slope_basis_ * own)};
}

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
        const HarmonicBalance::History history = balance.calcMiddleHistory(Q, frequency, a);
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
