#include "identify/problem/dynamic_stiffness.hpp"

namespace wems::identify {

std::complex<double> DynamicStiffness::at(double w) const {
    std::complex<double> sum(stiffness, w * damping);
    for (const MaxwellBranch& branch : branches)
        sum -= branch.stiffness / std::complex<double>(1, w * branch.time_constant);
    return sum;
}

DynamicStiffness calcDynamicStiffness(const OpenLoopRun& run, AxisLaw law, Eigen::Index row) {
    law.friction.reset();
    const AxisForce force(law);
    const std::vector<double> z(static_cast<std::size_t>(force.stateCount()) + 1, 0.0);
    constexpr int kEvery = 4;  // samples; the mean of thousands needs no more
    DynamicStiffness mean;
    double count = 0;
    for (int k = 0; k < run.sampleCount(); k += kEvery) {
        mean.stiffness += force.calcStiffness(run.q(row, k), run.v(row, k), run.time[k], z.data());
        mean.damping += force.calcDamping(run.q(row, k), run.v(row, k), run.time[k], z.data());
        ++count;
    }
    mean.stiffness /= count;
    mean.damping /= count;
    mean.branches = force.branches();
    return mean;
}

Eigen::RowVectorXd calcStiffnessFluctuation(const OpenLoopRun& run, const AxisLaw& law, Eigen::Index row) {
    const AxisForce force(law);
    Eigen::RowVectorXd stiffness(run.sampleCount());
    for (Eigen::Index k = 0; k < stiffness.size(); ++k) stiffness[k] = force.calcStaticStiffness(run.q(row, k));
    if ((stiffness.array() == stiffness[0]).all()) return Eigen::RowVectorXd::Zero(stiffness.size());
    return stiffness.array() - stiffness.mean();
}

}  // namespace wems::identify
