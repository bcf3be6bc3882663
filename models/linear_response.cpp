#include "models/linear_response.hpp"

#include <Eigen/LU>

#include "models/mount_forces.hpp"
#include "models/pi.hpp"

namespace wems {
namespace {

using Complex = std::complex<double>;

Complex calcBranchStiffness(const MaxwellBranch& branch, double omega) {
    const Complex product(0, omega * branch.time_constant);
    return branch.stiffness * product / (1.0 + product);
}

}  // namespace

Eigen::MatrixXcd calcDynamicStiffness(const LinearSystem& system, double omega) {
    Eigen::MatrixXcd dynamic =
        (system.stiffness - omega * omega * system.mass).cast<Complex>() + Complex(0, omega) * system.damping;
    for (const LinearBranch& branch : system.branches) {
        const Eigen::RowVectorXd row = system.ends[branch.connection].row(branch.axis);
        dynamic += calcBranchStiffness(branch.branch, omega) * (row.transpose() * row).cast<Complex>();
    }
    return dynamic;
}

LinearDynamics::LinearDynamics(const MountModel& model) : system_(linearizeExactly(model)) {
    const MountForces laws(model);
    const StaticEquilibrium rest = findStaticEquilibrium(model);
    FrameMotion fixed;
    if (!model.bracket.empty())
        fixed = Bracket(model.bracket).calcMotion(rest.eta, Eigen::VectorXd::Zero(rest.eta.size()));
    for (int i = 0; i < laws.connectionCount(); ++i) {
        const Eigen::Vector3d q = calcRelativeMotion(rest.mobile, fixed, model.connections[i].position).q;
        Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero(), damping = stiffness;
        for (int k = 0; k < 3; ++k) {
            const AxisForce& axis = laws.axis(i, k);
            const double* z = rest.states.data() + laws.stateOffset(i, k);
            stiffness(k, k) = axis.calcStaticStiffness(q[k]) + axis.draggedStiffness();
            damping(k, k) = axis.calcDamping(q[k], 0, 0, z);
        }
        stiffness_.push_back(stiffness);
        damping_.push_back(damping);
    }
}

Eigen::VectorXcd LinearDynamics::calcMotion(double frequency, const HarmonicInput& input) const {
    const Eigen::VectorXd force = system_.load * input.load + system_.base * input.base;
    return calcDynamicStiffness(system_, kTwoPi * frequency).partialPivLu().solve(force.cast<Complex>());
}

std::vector<ConnectionResponse> LinearDynamics::calcResponse(double frequency, const HarmonicInput& input) const {
    const double omega = kTwoPi * frequency;
    const Eigen::VectorXcd x = calcMotion(frequency, input);
    std::vector<ConnectionResponse> response;
    for (std::size_t i = 0; i < system_.ends.size(); ++i) {
        ConnectionResponse end;
        end.relative = system_.ends[i] * x;
        end.force = (stiffness_[i] + Complex(0, omega) * damping_[i]) * end.relative;
        end.mobile_acceleration = input.base - omega * omega * (system_.mobile_ends[i] * x);
        end.fixed_acceleration = input.base - omega * omega * (system_.fixed_ends[i] * x);
        response.push_back(end);
    }
    for (const LinearBranch& branch : system_.branches) {
        ConnectionResponse& end = response[branch.connection];
        end.force[branch.axis] += calcBranchStiffness(branch.branch, omega) * end.relative[branch.axis];
    }
    return response;
}

}  // namespace wems
