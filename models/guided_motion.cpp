#include "models/guided_motion.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "models/bryant.hpp"

namespace wems {
namespace {

/// d/dt of N(α, β) for w = N (α', β', γ'), times the rates.
Eigen::Vector3d calcAngularBias(const Eigen::Vector3d& angles, const Eigen::Vector3d& rates) {
    // w = e_x α' + e_1 β' + e_2 γ' with e_1 = Rx e_y, e_2 = Rx Ry e_z; each axis turns with those before it.
    const Eigen::Matrix3d N = bryantRatesToAngularVelocity(angles);
    const Eigen::Vector3d first = N.col(0) * rates[0];
    const Eigen::Vector3d second = first + N.col(1) * rates[1];
    return first.cross(N.col(1)) * rates[1] + second.cross(N.col(2)) * rates[2];
}

}  // namespace

Vector6 calcRelativeCoordinates(const BodyMotion& mobile, const FrameMotion& fixed) {
    Vector6 s;
    s << fixed.R_GF.transpose() * (mobile.p_GM - fixed.p_GF), bryantFromRotation(fixed.R_GF.transpose() * mobile.R_GM);
    return s;
}

Vector6 calcRelativeRates(const BodyMotion& mobile, const FrameMotion& fixed) {
    const Eigen::Matrix3d R_FG = fixed.R_GF.transpose();
    const Eigen::Vector3d arm = mobile.p_GM - fixed.p_GF;
    const Eigen::Vector3d angles = bryantFromRotation(R_FG * mobile.R_GM);
    Vector6 rates;
    rates << R_FG * (mobile.v_GM - fixed.v_GF - fixed.w_GF.cross(arm)),
        angularVelocityToBryantRates(angles) * (R_FG * (mobile.w_GM - fixed.w_GF));
    return rates;
}

BodyMotion composeMotion(const FrameMotion& fixed, const Vector6& s, const Vector6& s_rate) {
    const Eigen::Vector3d arm = fixed.R_GF * s.head<3>();
    const Eigen::Vector3d w_FM = bryantRatesToAngularVelocity(s.tail<3>()) * s_rate.tail<3>();
    BodyMotion mobile;
    mobile.R_GM = fixed.R_GF * rotationFromBryant(s.tail<3>());
    mobile.p_GM = fixed.p_GF + arm;
    mobile.w_GM = fixed.w_GF + fixed.R_GF * w_FM;
    mobile.v_GM = fixed.v_GF + fixed.w_GF.cross(arm) + fixed.R_GF * s_rate.head<3>();
    return mobile;
}

Matrix6 calcRelativeJacobian(const Eigen::Matrix3d& R_GF, const Vector6& s) {
    Matrix6 J = Matrix6::Zero();
    J.topLeftCorner<3, 3>() = R_GF;
    J.bottomRightCorner<3, 3>() = R_GF * bryantRatesToAngularVelocity(s.tail<3>());
    return J;
}

Vector6 composeAcceleration(const FrameMotion& fixed, const Vector6& frame_acceleration, const Vector6& s,
                            const Vector6& s_rate, const Vector6& s_acceleration) {
    const Eigen::Vector3d arm = fixed.R_GF * s.head<3>(), v_FM = fixed.R_GF * s_rate.head<3>();
    const Eigen::Vector3d w_FM = fixed.R_GF * (bryantRatesToAngularVelocity(s.tail<3>()) * s_rate.tail<3>());
    const Eigen::Vector3d linear = frame_acceleration.head<3>(), angular = frame_acceleration.tail<3>();
    const Eigen::Vector3d& w = fixed.w_GF;
    Vector6 acceleration = calcRelativeJacobian(fixed.R_GF, s) * s_acceleration;
    acceleration.head<3>() += linear + angular.cross(arm) + w.cross(w.cross(arm)) + 2 * w.cross(v_FM);
    acceleration.tail<3>() += angular + w.cross(w_FM) + fixed.R_GF * calcAngularBias(s.tail<3>(), s_rate.tail<3>());
    return acceleration;
}

Matrix6 calcTransport(const Eigen::Vector3d& arm) {
    Matrix6 T = Matrix6::Identity();
    T.topRightCorner<3, 3>() = -crossMatrix(arm);
    return T;
}

GuidedMotion::GuidedMotion(const MobileBody& body) : body_(body) {
    for (int i = 0; i < 6; ++i) (body.free[i] ? free_ : held_).push_back(i);
}

bool GuidedMotion::moves(const Eigen::Vector3d& position, int axis) const {
    return std::any_of(free_.begin(), free_.end(), [&](int motion) {
        if (motion < 3) return motion == axis;
        const int about = motion - 3;
        return about != axis && position[3 - about - axis] != 0;
    });
}

Eigen::MatrixXd GuidedMotion::freeColumns(const Eigen::MatrixXd& matrix) const {
    Eigen::MatrixXd columns(matrix.rows(), free_.size());
    for (std::size_t j = 0; j < free_.size(); ++j) columns.col(j) = matrix.col(free_[j]);
    return columns;
}

void GuidedMotion::project(BodyMotion& mobile, const FrameMotion& fixed) const {
    Vector6 s = calcRelativeCoordinates(mobile, fixed), rates = calcRelativeRates(mobile, fixed);
    for (const int i : held_) s[i] = rates[i] = 0;
    mobile = composeMotion(fixed, s, rates);
}

Vector6 GuidedMotion::calcAcceleration(const BodyMotion& mobile, const FrameMotion& fixed, const Vector6& frame_bias,
                                       const Wrench& applied, const Eigen::MatrixXd& frame_jacobian,
                                       // A Ref is a view to write through. NOLINTNEXTLINE
                                       Eigen::Ref<Eigen::VectorXd> modal, double stabilization) const {
    const Vector6 s = calcRelativeCoordinates(mobile, fixed), rates = calcRelativeRates(mobile, fixed);
    Vector6 wanted = Vector6::Zero();
    for (const int i : held_) wanted[i] = -stabilization * (2 * rates[i] + stabilization * s[i]);

    // From M's origin to the CoG.
    const Eigen::Vector3d arm = mobile.R_GM * body_.center_of_gravity;
    const Matrix6 to_cog = calcTransport(arm);
    Vector6 bias = to_cog * composeAcceleration(fixed, frame_bias, s, rates, wanted);
    bias.head<3>() += mobile.w_GM.cross(mobile.w_GM.cross(arm));

    const auto free = static_cast<Eigen::Index>(free_.size()), modes = frame_jacobian.cols();
    Eigen::MatrixXd C(6, free + modes);
    C.leftCols(free) = to_cog * freeColumns(calcRelativeJacobian(fixed.R_GF, s));
    C.rightCols(modes) = calcTransport(mobile.p_GM + arm - fixed.p_GF) * frame_jacobian;

    const Eigen::Matrix3d inertia = mobile.R_GM * body_.inertia * mobile.R_GM.transpose();
    Matrix6 mass = Matrix6::Zero();
    mass.topLeftCorner<3, 3>().diagonal().setConstant(body_.mass);
    mass.bottomRightCorner<3, 3>() = inertia;
    Vector6 force;
    force << applied.force, applied.moment - mobile.w_GM.cross(inertia * mobile.w_GM + mobile.R_GM * body_.spin);

    const Eigen::MatrixXd MC = mass * C;
    Eigen::MatrixXd system = C.transpose() * MC;
    system.diagonal().tail(modes).array() += 1;
    Eigen::VectorXd right = C.transpose() * force - MC.transpose() * bias;
    if (modes > 0) right.tail(modes) += modal;
    const Eigen::VectorXd solution = system.llt().solve(right);
    if (modes > 0) modal = solution.tail(modes);
    return C * solution + bias;
}

}  // namespace wems
