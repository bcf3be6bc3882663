#include "identify/problem/axis_tangent.hpp"

namespace wems::identify {

AxisTangent::AxisTangent(const OpenLoopRun& run, const AxisLaw& law, Eigen::Index row)
    : damping_(law.damping), stops_(law, run.q.row(row).transpose(), run.v.row(row).transpose(), run.interval) {
    AxisLaw bare = law;
    bare.stops.clear();
    spring_ = calcTangent(run, bare, row);
    const DynamicStiffness whole = calcDynamicStiffness(run, law, row), without = calcDynamicStiffness(run, bare, row);
    stop_stiffness_ = whole.stiffness - without.stiffness;
    stop_damping_ = whole.damping - without.damping;
}

Eigen::VectorXd AxisTangent::calcChange(const Eigen::Ref<const Eigen::VectorXd>& q,
                                        const Eigen::Ref<const Eigen::VectorXd>& v) const {
    return spring_.cwiseProduct(q) + damping_ * v + stops_.apply(q, v);
}

Eigen::VectorXd AxisTangent::calcBeyondMean(const Eigen::Ref<const Eigen::VectorXd>& q,
                                            const Eigen::Ref<const Eigen::VectorXd>& v) const {
    return (spring_.array() - spring_.mean()).matrix().cwiseProduct(q) + stops_.apply(q, v) - stop_stiffness_ * q -
           stop_damping_ * v;
}

}  // namespace wems::identify
