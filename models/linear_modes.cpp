#include "models/linear_modes.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <optional>

#include "models/bryant.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/common/units.hpp"
#include "models/guided_motion.hpp"
#include "models/mount_forces.hpp"

namespace wems {
namespace {

/// Exact kinematics about rest, with the forces of one axis linear in its displacement.
class RestNeighbourhood {
public:
    /// @param omega rad/s, at which branches are frozen; none: they are left out
    RestNeighbourhood(const MountModel& model, std::optional<double> omega)
        : model_(model), bracket_(model.bracket), guide_(model.body), rest_(findStaticEquilibrium(model)) {
        if (rest_.eta.size() == 0) rest_.eta = Eigen::VectorXd::Zero(bracket_.modeCount());
        const MountForces laws(model);
        const Eigen::Index connections = laws.connectionCount();
        for (auto* values : {&rest_q_, &rest_force_, &stiffness_, &damping_}) values->resize(3, connections);
        for (int i = 0; i < laws.connectionCount(); ++i) {
            rest_q_.col(i) = calcDisplacement(i, Eigen::VectorXd::Zero(size()));
            for (int k = 0; k < 3; ++k) {
                const AxisForce& axis = laws.axis(i, k);
                const double q = rest_q_(k, i);
                const double* z = rest_.states.data() + laws.stateOffset(i, k);
                rest_force_(k, i) = axis.calcStaticForce(q);
                stiffness_(k, i) = axis.calcStaticStiffness(q) + axis.draggedStiffness();
                damping_(k, i) = axis.calcDamping(q, 0, 0, z);
                for (const MaxwellBranch& branch : axis.branches()) {
                    if (!omega) {
                        branches_.push_back({i, k, branch});
                        continue;
                    }
                    const double product = *omega * branch.time_constant;
                    stiffness_(k, i) += branch.stiffness * product * product / (1 + product * product);
                    damping_(k, i) += branch.stiffness * branch.time_constant / (1 + product * product);
                }
            }
        }
    }

    Eigen::Index size() const { return bodySize() + bracket_.modeCount(); }
    Eigen::Index bodySize() const { return static_cast<Eigen::Index>(guide_.free().size()); }
    /// (displacement of Mo, small rotation, modal coordinates) = T x, 6 + modes rows.
    Eigen::MatrixXd calcReduction(const Eigen::VectorXd& x) const {
        const Eigen::Index modes = bracket_.modeCount();
        Eigen::MatrixXd T = Eigen::MatrixXd::Identity(6 + modes, 6 + modes);
        if (!guide_.active()) return T;
        const Eigen::VectorXd eta = rest_.eta + x.tail(modes);
        const Bracket::Kinematics fixed = bracket_.calcKinematics(eta, Eigen::VectorXd::Zero(modes));
        const BodyMotion mobile = moveMobile(x);
        T.resize(6 + modes, size());
        T.setZero();
        T.topLeftCorner(6, bodySize()) =
            guide_.freeColumns(calcRelativeJacobian(fixed.motion.R_GF, calcRelativeCoordinates(mobile, fixed.motion)));
        T.topRightCorner(6, modes) =
            calcTransport(mobile.p_GM - fixed.motion.p_GF) * bracket_.calcFrameJacobian(fixed.jacobian);
        T.bottomRightCorner(modes, modes).setIdentity();
        return T;
    }
    int connectionCount() const { return static_cast<int>(rest_q_.cols()); }
    const Eigen::Matrix3d& restRotation() const { return rest_.mobile.R_GM; }
    Eigen::Vector3d damping(int connection) const { return damping_.col(connection); }
    const std::vector<LinearBranch>& branches() const { return branches_; }

    /// Position of an end in G.
    Eigen::Vector3d calcMobileEnd(int connection, const Eigen::VectorXd& x) const {
        const BodyMotion mobile = moveMobile(x);
        return mobile.p_GM + mobile.R_GM * position(connection);
    }
    /// Displacement and small rotation of M and of F.
    Eigen::VectorXd calcMobileFrame(const Eigen::VectorXd& x) const {
        const BodyMotion mobile = moveMobile(x);
        Eigen::VectorXd frame(6);
        frame << mobile.p_GM, vectorFromRotation(mobile.R_GM * rest_.mobile.R_GM.transpose());
        return frame;
    }
    Eigen::VectorXd calcFixedFrame(const Eigen::VectorXd& x) const {
        const FrameMotion fixed = moveFixed(x), rest = moveFixed(Eigen::VectorXd::Zero(size()));
        Eigen::VectorXd frame(6);
        frame << fixed.p_GF, vectorFromRotation(fixed.R_GF * rest.R_GF.transpose());
        return frame;
    }
    Eigen::Vector3d calcFixedEnd(int connection, const Eigen::VectorXd& x) const {
        const FrameMotion fixed = moveFixed(x);
        return fixed.p_GF + fixed.R_GF * position(connection);
    }

    /// q of a connection, F axes, after a small motion x from rest.
    Eigen::Vector3d calcDisplacement(int connection, const Eigen::VectorXd& x) const {
        return calcRelativeMotion(moveMobile(x), moveFixed(x), position(connection)).q;
    }

    /// Generalized forces (Mo, rotation, modes) of a unit force at a load point.
    Eigen::MatrixXd calcLoadMatrix(const LoadPoint& point) const {
        const Eigen::Index modes = bracket_.modeCount();
        const bool mobile = point.part == Part::mobile;
        const Bracket::Kinematics fixed = bracket_.calcKinematics(rest_.eta, Eigen::VectorXd::Zero(modes));
        Eigen::MatrixXd wrench(6, 3);
        const Eigen::Matrix3d R = mobile ? rest_.mobile.R_GM : fixed.motion.R_GF;
        wrench << Eigen::Matrix3d::Identity(), crossMatrix(R * point.position);
        Eigen::MatrixXd load = Eigen::MatrixXd::Zero(6 + modes, 3);
        if (mobile)
            load.topRows(6) = wrench;
        else
            load.bottomRows(modes) = bracket_.calcFrameJacobian(fixed.jacobian).transpose() * wrench;
        return load;
    }

    /// Generalized forces that pull back to rest.
    Eigen::VectorXd calcRestoringForce(const Eigen::VectorXd& x) const {
        const BodyMotion mobile = moveMobile(x);
        const FrameMotion fixed = moveFixed(x);
        const Eigen::Vector3d weight = model_.body.mass * model_.gravity;
        Eigen::VectorXd force = Eigen::VectorXd::Zero(6 + bracket_.modeCount());
        force.head<3>() = -weight;
        force.segment<3>(3) = -(mobile.R_GM * model_.body.center_of_gravity).cross(weight);
        Wrench on_fixed;
        for (int i = 0; i < connectionCount(); ++i) {
            const Eigen::Vector3d q = calcRelativeMotion(mobile, fixed, position(i)).q;
            const Eigen::Vector3d f_F =
                rest_force_.col(i) + Eigen::Vector3d(stiffness_.col(i)).cwiseProduct(q - rest_q_.col(i));
            const Eigen::Vector3d f_G = fixed.R_GF * f_F;
            const Eigen::Vector3d arm = mobile.R_GM * position(i);
            force.head<3>() += f_G;
            force.segment<3>(3) += arm.cross(f_G);
            on_fixed.force += f_G;
            on_fixed.moment += (mobile.p_GM + arm - fixed.p_GF).cross(f_G);
        }
        const Eigen::VectorXd eta = rest_.eta + x.tail(bracket_.modeCount());
        Eigen::VectorXd modal(eta.size());
        bracket_.calcAccelerations(eta, Eigen::VectorXd::Zero(eta.size()), on_fixed, Eigen::Vector3d::Zero(),
                                   Eigen::Vector3d::Zero(), modal);
        force.tail(eta.size()) = -modal;
        if (guide_.active()) return calcReduction(x).transpose() * force;
        return force;
    }

private:
    const Eigen::Vector3d& position(int connection) const { return model_.connections[connection].position; }
    BodyMotion moveMobile(const Eigen::VectorXd& x) const {
        BodyMotion mobile = rest_.mobile;
        if (guide_.active()) {
            Vector6 s = calcRelativeCoordinates(mobile, moveFixed(Eigen::VectorXd::Zero(size())));
            for (std::size_t j = 0; j < guide_.free().size(); ++j) s[guide_.free()[j]] += x[j];
            return composeMotion(moveFixed(x), s, Vector6::Zero());
        }
        mobile.p_GM += x.head<3>();
        mobile.R_GM = rotationFromVector(x.segment<3>(3)) * mobile.R_GM;
        return mobile;
    }
    FrameMotion moveFixed(const Eigen::VectorXd& x) const {
        const Eigen::VectorXd eta = rest_.eta + x.tail(bracket_.modeCount());
        return bracket_.calcMotion(eta, Eigen::VectorXd::Zero(eta.size()));
    }

    const MountModel& model_;
    Bracket bracket_;
    GuidedMotion guide_;
    StaticEquilibrium rest_;
    Eigen::Matrix3Xd rest_q_, rest_force_, stiffness_, damping_;
    std::vector<LinearBranch> branches_;
};

/// Columns: central differences of `function` along each coordinate. The functions are smooth; the step is large
/// against rounding and its square small.
template <class Function>
Eigen::MatrixXd differentiate(const Function& function, Eigen::Index size) {
    constexpr double step = 1e-5;  // m, rad, kg^1/2 m
    Eigen::MatrixXd jacobian;
    for (Eigen::Index j = 0; j < size; ++j) {
        const Eigen::VectorXd delta = step * Eigen::VectorXd::Unit(size, j);
        const Eigen::VectorXd column = (function(delta) - function(-delta)) / (2 * step);
        if (j == 0) jacobian.resize(column.size(), size);
        jacobian.col(j) = column;
    }
    return jacobian;
}

LinearSystem linearizeAt(const MountModel& model, std::optional<double> omega) {
    const RestNeighbourhood rest(model, omega);
    const Eigen::Index n = rest.size();
    const Eigen::Index modes = model.bracket.size();
    const Eigen::MatrixXd T = rest.calcReduction(Eigen::VectorXd::Zero(n));
    LinearSystem system;
    system.branches = rest.branches();

    const Eigen::Matrix3d R = rest.restRotation();
    const Eigen::Matrix3d arm = crossMatrix(R * model.body.center_of_gravity);
    Eigen::MatrixXd mass = Eigen::MatrixXd::Identity(6 + modes, 6 + modes);
    mass.topLeftCorner<3, 3>() *= model.body.mass;
    mass.block<3, 3>(0, 3) = -model.body.mass * arm;
    mass.block<3, 3>(3, 0) = model.body.mass * arm;
    mass.block<3, 3>(3, 3) = R * model.body.inertia * R.transpose() - model.body.mass * arm * arm;
    system.mass = T.transpose() * mass * T;

    const Eigen::MatrixXd stiffness =
        differentiate([&](const Eigen::VectorXd& x) { return rest.calcRestoringForce(x); }, n);
    system.stiffness = 0.5 * (stiffness + stiffness.transpose());  // symmetric but for rounding

    system.damping = Eigen::MatrixXd::Zero(n, n);
    for (int i = 0; i < rest.connectionCount(); ++i) {
        system.ends.push_back(
            differentiate([&](const Eigen::VectorXd& x) { return Eigen::VectorXd(rest.calcDisplacement(i, x)); }, n));
        system.damping += system.ends.back().transpose() * rest.damping(i).asDiagonal() * system.ends.back();
        system.mobile_ends.push_back(
            differentiate([&](const Eigen::VectorXd& x) { return Eigen::VectorXd(rest.calcMobileEnd(i, x)); }, n));
        system.fixed_ends.push_back(
            differentiate([&](const Eigen::VectorXd& x) { return Eigen::VectorXd(rest.calcFixedEnd(i, x)); }, n));
    }
    system.mobile_frame = differentiate([&](const Eigen::VectorXd& x) { return rest.calcMobileFrame(x); }, n);
    system.fixed_frame = differentiate([&](const Eigen::VectorXd& x) { return rest.calcFixedFrame(x); }, n);

    Eigen::MatrixXd damping = Eigen::MatrixXd::Zero(6 + modes, 6 + modes);
    damping.block<3, 3>(3, 3) = -crossMatrix(R * model.body.spin);  // moment −ω × h on the body
    Eigen::MatrixXd load = Eigen::MatrixXd::Zero(6 + modes, 3);
    Eigen::MatrixXd base = -mass.leftCols(3);  // inertia forces of the mobile part; of the bracket below
    for (Eigen::Index j = 0; j < modes; ++j) {
        const BracketMode& mode = model.bracket[j];
        damping(6 + j, 6 + j) = 2 * mode.damping_ratio * kTwoPi * mode.frequency;
        if (!model.load_point) load.row(6 + j) = mode.load_translation.transpose();
        base.row(6 + j) = -mode.base_participation.transpose();
    }
    if (model.load_point) load += rest.calcLoadMatrix(*model.load_point);
    system.damping += T.transpose() * damping * T;
    system.load = T.transpose() * load;
    system.base = T.transpose() * base;
    return system;
}

}  // namespace

LinearSystem linearize(const MountModel& model, double reference_frequency) {
    return linearizeAt(model, kTwoPi * reference_frequency);
}

LinearSystem linearizeExactly(const MountModel& model) {
    return linearizeAt(model, std::nullopt);
}

LinearModes findLinearModes(const LinearSystem& system) {
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(system.stiffness, system.mass);
    const Eigen::VectorXd& squares = solver.eigenvalues();
    // Rounding of a free direction lies far below this share of the stiffest mode.
    if (squares.minCoeff() < -1e-9 * squares.maxCoeff())
        throw InputError({{}, 0, "gravity"}, "the static equilibrium is not stable (ω² = " +
                                                 formatNumber(squares.minCoeff(), 3) + " 1/s²)");
    return {squares.cwiseMax(0).cwiseSqrt() / kTwoPi, solver.eigenvectors()};
}

}  // namespace wems
