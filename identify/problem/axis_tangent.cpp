#include "identify/problem/axis_tangent.hpp"

namespace wems::identify {

AxisTangent::AxisTangent(const OpenLoopRun& run, const AxisLaw& law, Eigen::Index row)
    : damping_(law.damping),
      stops_(law, run.q.row(row).transpose(), run.v.row(row).transpose(), run.interval),
      path_(law, run.q.row(row).transpose(), run.v.row(row).transpose(), run.interval) {
    AxisLaw bare = law;
    bare.stops.clear();
    spring_ = calcTangent(run, bare, row);
    if (law.drift != 0)
        for (Eigen::Index k = 0; k < spring_.size(); ++k) spring_[k] += law.stiffness * law.drift * run.time[k];
    const DynamicStiffness whole = calcDynamicStiffness(run, law, row), without = calcDynamicStiffness(run, bare, row);
    stop_stiffness_ = whole.stiffness - without.stiffness;
    stop_damping_ = whole.damping - without.damping;
    branches_ = whole.branches;
    if (law.friction && !law.friction->presliding_stiffness) {
        sliding_force_ = law.friction->force;
        sliding_ = SlidingDerivative(run.quiet.of(row), law.friction->transition_velocity);
    }
    is_beyond_mean_ = sliding_force_ != 0 || law.drift != 0 || !path_.isZero() ||
                      (calcTangent(run, law, row).array() != AxisForce(law).calcStaticStiffness(0)).any();
}

/// Friction and what is dragged along.
Eigen::VectorXd AxisTangent::calcOfPath(const Eigen::Ref<const Eigen::VectorXd>& q,
                                        const Eigen::Ref<const Eigen::VectorXd>& v) const {
    Eigen::VectorXd change = Eigen::VectorXd::Zero(q.size());
    if (!path_.isZero()) change += path_.apply(q, v);
    if (sliding_force_ != 0) change += sliding_force_ * sliding_.apply(v);
    return change;
}

Eigen::VectorXd AxisTangent::calcChange(const Eigen::Ref<const Eigen::VectorXd>& q,
                                        const Eigen::Ref<const Eigen::VectorXd>& v) const {
    return spring_.cwiseProduct(q) + damping_ * v + stops_.apply(q, v) + calcOfPath(q, v);
}

Eigen::VectorXd AxisTangent::calcBeyondMean(const Eigen::Ref<const Eigen::VectorXd>& q,
                                            const Eigen::Ref<const Eigen::VectorXd>& v) const {
    return (spring_.array() - spring_.mean()).matrix().cwiseProduct(q) + stops_.apply(q, v) - stop_stiffness_ * q -
           stop_damping_ * v + calcOfPath(q, v);
}

std::complex<double> AxisTangent::calcRelaxing(double w) const {
    std::complex<double> sum = 0;
    for (const MaxwellBranch& branch : branches_) {
        const std::complex<double> turned(0, w * branch.time_constant);
        sum += branch.stiffness * turned / (1.0 + turned);
    }
    return sum;
}

}  // namespace wems::identify
