#include "models/bracket.hpp"

#include <utility>

#include "models/bryant.hpp"
#include "models/pi.hpp"

namespace wems {

namespace {

/// shape · coordinates. A column at a time: there are few, perhaps none, and Eigen's general kernels cost more.
Eigen::Vector3d combine(const Eigen::Matrix3Xd& shape, const Eigen::Ref<const Eigen::VectorXd>& coordinates) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (Eigen::Index j = 0; j < shape.cols(); ++j) sum += shape.col(j) * coordinates[j];
    return sum;
}

}  // namespace

Bracket::Bracket(std::vector<BracketMode> modes) : modes_(std::move(modes)) {
    const Eigen::Index n = modes_.size();
    for (auto* shape : {&translation_, &rotation_, &load_, &base_}) shape->resize(3, n);
    omega_squared_.resize(n);
    two_zeta_omega_.resize(n);
    for (Eigen::Index j = 0; j < n; ++j) {
        const BracketMode& mode = modes_[j];
        const double omega = kTwoPi * mode.frequency;
        translation_.col(j) = mode.translation;
        rotation_.col(j) = mode.rotation;
        load_.col(j) = mode.load_translation;
        base_.col(j) = mode.base_participation;
        omega_squared_[j] = omega * omega;
        two_zeta_omega_[j] = 2 * mode.damping_ratio * omega;
    }
}

Bracket::Kinematics Bracket::calcKinematics(const Eigen::Ref<const Eigen::VectorXd>& eta,
                                            const Eigen::Ref<const Eigen::VectorXd>& eta_dot) const {
    Eigen::Vector3d theta = Eigen::Vector3d::Zero(), theta_dot = theta, p = theta, v = theta;
    for (Eigen::Index j = 0; j < eta.size(); ++j) {
        theta += eta[j] * rotation_.col(j);
        theta_dot += eta_dot[j] * rotation_.col(j);
        p += eta[j] * translation_.col(j);
        v += eta_dot[j] * translation_.col(j);
    }
    Kinematics result;
    result.jacobian = leftJacobian(theta);
    // exp(K) = 1 + K B, since B is the series of exp with every term divided by K once.
    result.motion.R_GF = Eigen::Matrix3d::Identity() + crossMatrix(theta) * result.jacobian;
    result.motion.p_GF = p;
    result.motion.w_GF = result.jacobian * theta_dot;
    result.motion.v_GF = v;
    return result;
}

FrameMotion Bracket::calcMotion(const Eigen::Ref<const Eigen::VectorXd>& eta,
                                const Eigen::Ref<const Eigen::VectorXd>& eta_dot) const {
    return calcKinematics(eta, eta_dot).motion;
}

Bracket::FrameAcceleration Bracket::calcAcceleration(const Eigen::Ref<const Eigen::VectorXd>& eta,
                                                     const Eigen::Ref<const Eigen::VectorXd>& eta_dot,
                                                     const Eigen::Ref<const Eigen::VectorXd>& eta_dot_dot) const {
    const Eigen::Vector3d theta = combine(rotation_, eta);
    const Eigen::Vector3d theta_dot = combine(rotation_, eta_dot);
    const Eigen::Vector3d theta_dot_dot = combine(rotation_, eta_dot_dot);
    return {leftJacobian(theta) * theta_dot_dot + leftJacobianRate(theta, theta_dot) * theta_dot,
            combine(translation_, eta_dot_dot)};
}

Eigen::MatrixXd Bracket::calcFrameJacobian(const Eigen::Matrix3d& jacobian) const {
    Eigen::MatrixXd J(6, modeCount());
    J << translation_, jacobian * rotation_;
    return J;
}

void Bracket::calcAccelerations(const Eigen::Ref<const Eigen::VectorXd>& eta,
                                const Eigen::Ref<const Eigen::VectorXd>& eta_dot, const Wrench& at_interface,
                                const Eigen::Vector3d& load, const Eigen::Vector3d& base_acceleration,
                                // A Ref is a view to write through. NOLINTNEXTLINE(performance-unnecessary-value-param)
                                Eigen::Ref<Eigen::VectorXd> eta_dot_dot) const {
    const Eigen::Vector3d theta = combine(rotation_, eta);
    calcAccelerations(leftJacobian(theta), eta, eta_dot, at_interface, load, base_acceleration, eta_dot_dot);
}

void Bracket::calcAccelerations(const Eigen::Matrix3d& jacobian, const Eigen::Ref<const Eigen::VectorXd>& eta,
                                const Eigen::Ref<const Eigen::VectorXd>& eta_dot, const Wrench& at_interface,
                                const Eigen::Vector3d& load, const Eigen::Vector3d& base_acceleration,
                                Eigen::Ref<Eigen::VectorXd> eta_dot_dot) const {
    const Eigen::Vector3d torque = jacobian.transpose() * at_interface.moment;
    for (Eigen::Index j = 0; j < eta.size(); ++j) {
        eta_dot_dot[j] = translation_.col(j).dot(at_interface.force) + rotation_.col(j).dot(torque) +
                         load_.col(j).dot(load) - base_.col(j).dot(base_acceleration) -
                         two_zeta_omega_[j] * eta_dot[j] - omega_squared_[j] * eta[j];
    }
}

double Bracket::calcEnergy(const Eigen::Ref<const Eigen::VectorXd>& eta,
                           const Eigen::Ref<const Eigen::VectorXd>& eta_dot) const {
    return 0.5 * (eta_dot.squaredNorm() + (omega_squared_.array() * eta.array().square()).sum());
}

double Bracket::calcDissipatedPower(const Eigen::Ref<const Eigen::VectorXd>& eta_dot) const {
    return (two_zeta_omega_.array() * eta_dot.array().square()).sum();
}

}  // namespace wems
