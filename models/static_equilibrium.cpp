#include "models/static_equilibrium.hpp"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <cmath>

#include "models/bryant.hpp"
#include "models/common/error.hpp"
#include "models/guided_motion.hpp"
#include "models/mount_forces.hpp"

namespace wems {

namespace {

/// Unknowns: position of Mo (m), a rotation about G axes (rad), modal coordinates. The rotation is kept as a matrix and
/// turned by small vectors, so that there is no singular attitude. Of a guided part its free coordinates and the modal
/// ones.
struct Pose {
    BodyMotion mobile;
    Eigen::VectorXd eta;
};

class EquilibriumProblem {
public:
    explicit EquilibriumProblem(const MountModel& model)
        : model_(model),
          forces_(model),
          bracket_(model.bracket),
          guide_(model.body),
          zero_modes_(Eigen::VectorXd::Zero(bracket_.modeCount())) {}

    Pose initialPose() const { return {BodyMotion{}, zero_modes_}; }
    Eigen::Index size() const { return bodySize() + zero_modes_.size(); }

    Pose move(const Pose& pose, const Eigen::VectorXd& step) const {
        Pose moved = pose;
        if (guide_.active()) {
            Vector6 s = calcRelativeCoordinates(pose.mobile, fixedMotion(pose));
            for (const int i : guide_.held()) s[i] = 0;
            for (std::size_t j = 0; j < guide_.free().size(); ++j) s[guide_.free()[j]] += step[j];
            moved.eta += step.tail(zero_modes_.size());
            moved.mobile = composeMotion(fixedMotion(moved), s, Vector6::Zero());
            return moved;
        }
        moved.mobile.p_GM += step.head<3>();
        moved.mobile.R_GM = rotationFromVector(step.segment<3>(3)) * pose.mobile.R_GM;
        moved.eta += step.tail(zero_modes_.size());
        return moved;
    }

    FrameMotion fixedMotion(const Pose& pose) const { return bracket_.calcMotion(pose.eta, zero_modes_); }

    /// Force, moment about Mo, and modal force that are left over with this gravity.
    Eigen::VectorXd calcResidual(const Pose& pose, const Eigen::Vector3d& gravity) const {
        const FrameMotion fixed = fixedMotion(pose);
        const Eigen::Vector3d weight = model_.body.mass * gravity;
        Wrench on_fixed;
        Vector6 residual = Vector6::Zero();
        residual.head<3>() = weight;
        residual.segment<3>(3) = (pose.mobile.R_GM * model_.body.center_of_gravity).cross(weight);
        for (int i = 0; i < forces_.connectionCount(); ++i) {
            const Eigen::Vector3d& position = model_.connections[i].position;
            const Eigen::Vector3d q = calcRelativeMotion(pose.mobile, fixed, position).q;
            Eigen::Vector3d f_F;
            for (int k = 0; k < 3; ++k) f_F[k] = forces_.axis(i, k).calcStaticForce(q[k]);
            const Eigen::Vector3d f_G = fixed.R_GF * f_F;
            const Eigen::Vector3d arm = pose.mobile.R_GM * position;
            residual.head<3>() -= f_G;
            residual.segment<3>(3) -= arm.cross(f_G);
            on_fixed.force += f_G;
            on_fixed.moment += (pose.mobile.p_GM + arm - fixed.p_GF).cross(f_G);
        }
        Eigen::VectorXd modal(zero_modes_.size());
        bracket_.calcAccelerations(pose.eta, zero_modes_, on_fixed, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                   modal);
        Eigen::VectorXd all(size());
        if (guide_.active()) {
            // Virtual work: held directions hand their forces to the fixed part.
            const Bracket::Kinematics kinematics = bracket_.calcKinematics(pose.eta, zero_modes_);
            const Matrix6 J = calcRelativeJacobian(fixed.R_GF, calcRelativeCoordinates(pose.mobile, fixed));
            all.head(bodySize()) = guide_.freeColumns(J).transpose() * residual;
            modal += (calcTransport(pose.mobile.p_GM - fixed.p_GF) * bracket_.calcFrameJacobian(kinematics.jacobian))
                         .transpose() *
                     residual;
        } else {
            all.head<6>() = residual;
        }
        all.tail(zero_modes_.size()) = modal;
        return all;
    }

    /// Internal states when all has come to rest: dashpots of the branches follow q, bristles are unstretched.
    Eigen::VectorXd calcRelaxedStates(const Pose& pose) const {
        Eigen::VectorXd states = Eigen::VectorXd::Zero(forces_.stateCount());
        const FrameMotion fixed = fixedMotion(pose);
        for (int i = 0; i < forces_.connectionCount(); ++i) {
            const Eigen::Vector3d& position = model_.connections[i].position;
            const Eigen::Vector3d q = calcRelativeMotion(pose.mobile, fixed, position).q;
            for (int k = 0; k < 3; ++k) {
                const Eigen::Index branches = forces_.axis(i, k).branches().size();
                states.segment(forces_.stateOffset(i, k), branches).setConstant(q[k]);
            }
        }
        return states;
    }

private:
    Eigen::Index bodySize() const { return static_cast<Eigen::Index>(guide_.free().size()); }

    const MountModel& model_;
    MountForces forces_;
    Bracket bracket_;
    GuidedMotion guide_;
    Eigen::VectorXd zero_modes_;
};

Eigen::MatrixXd calcJacobian(const EquilibriumProblem& problem, const Pose& pose, const Eigen::Vector3d& gravity) {
    constexpr double step = 1e-7;  // m, rad, kg^1/2 m: small against every clearance, large against rounding
    Eigen::MatrixXd jacobian(problem.size(), problem.size());
    for (Eigen::Index j = 0; j < problem.size(); ++j) {
        const Eigen::VectorXd delta = step * Eigen::VectorXd::Unit(problem.size(), j);
        jacobian.col(j) = (problem.calcResidual(problem.move(pose, delta), gravity) -
                           problem.calcResidual(problem.move(pose, -delta), gravity)) /
                          (2 * step);
    }
    return jacobian;
}

/// Newton with a line search from `pose` on; false if it does not converge.
bool solve(const EquilibriumProblem& problem, const Eigen::Vector3d& gravity, double tolerance, Pose& pose) {
    constexpr int most_iterations = 50;
    constexpr int most_halvings = 12;
    Eigen::VectorXd residual = problem.calcResidual(pose, gravity);
    for (int i = 0; i < most_iterations; ++i) {
        if (residual.norm() <= tolerance) return true;
        // An axis without any stiffness makes the matrix singular; the shortest step leaves that axis where it is.
        const Eigen::VectorXd step =
            calcJacobian(problem, pose, gravity).completeOrthogonalDecomposition().solve(-residual);
        double length = 1;
        int halvings = 0;
        for (; halvings < most_halvings; ++halvings, length /= 2) {
            const Pose candidate = problem.move(pose, length * step);
            const Eigen::VectorXd left = problem.calcResidual(candidate, gravity);
            if (left.norm() < residual.norm()) {
                pose = candidate;
                residual = left;
                break;
            }
        }
        if (halvings == most_halvings) return false;
    }
    return false;
}

}  // namespace

StaticEquilibrium findStaticEquilibrium(const MountModel& model) {
    const EquilibriumProblem problem(model);
    Pose pose = problem.initialPose();
    // Relative to the weight; where there is none, to one millionth of a newton at stops that touch at rest.
    const double tolerance = 1e-10 * (model.body.mass * model.gravity.norm()) + 1e-12;
    if (!solve(problem, model.gravity, tolerance, pose)) {
        constexpr int gravity_steps = 32;
        pose = problem.initialPose();
        for (int i = 1; i <= gravity_steps; ++i) {
            if (!solve(problem, model.gravity * (double(i) / gravity_steps), tolerance, pose)) {
                throw InputError({{}, 0, "gravity"}, "the mount has no static equilibrium under this gravity",
                                 "stiffness along every direction in which the weight acts");
            }
        }
    }
    return {pose.mobile, pose.eta, problem.calcRelaxedStates(pose)};
}

std::string nameStop(const MountModel& model, const StopMargin& margin) {
    const Connection& connection = model.connections[margin.connection];
    const Stop& stop = connection.axis[margin.axis].stops[margin.stop];
    return connection.name + "." + "xyz"[margin.axis] + (stop.side == Side::positive ? ".+" : ".-");
}

StaticSag findStaticSag(const MountModel& model) {
    const StaticEquilibrium rest = findStaticEquilibrium(model);
    FrameMotion fixed;
    if (!model.bracket.empty())
        fixed = Bracket(model.bracket).calcMotion(rest.eta, Eigen::VectorXd::Zero(rest.eta.size()));
    const Eigen::Vector3d& center = model.body.center_of_gravity;
    StaticSag sag;
    sag.displacement = rest.mobile.p_GM + rest.mobile.R_GM * center - center;
    sag.rotation = vectorFromRotation(rest.mobile.R_GM);
    const MountForces laws(model);
    sag.relative.resize(3, laws.connectionCount());
    sag.force.resize(3, laws.connectionCount());
    for (int i = 0; i < laws.connectionCount(); ++i) {
        const Connection& connection = model.connections[i];
        sag.relative.col(i) = calcRelativeMotion(rest.mobile, fixed, connection.position).q;
        for (int k = 0; k < 3; ++k) {
            const double q = sag.relative(k, i);
            sag.force(k, i) = laws.axis(i, k).calcStaticForce(q);
            const AxisLaw& law = connection.axis[k];
            for (std::size_t s = 0; s < law.stops.size(); ++s) {
                const double direction = law.stops[s].side == Side::positive ? 1 : -1;
                sag.stops.push_back(
                    {i, k, s, law.stops[s].clearance, law.stops[s].clearance - direction * (q + law.offset)});
            }
        }
    }
    return sag;
}

}  // namespace wems
