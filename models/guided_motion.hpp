/// @file
/// A mobile part that is free to move in some of its six directions only, as in a guided rig.
///
/// The motion of M relative to F has the coordinates s = (x, y, z of M's origin in F axes, m; Bryant angles α, β, γ of
/// R_FM, rad). Those that are held stay zero, whatever F does:
///
///     p_GM = p_GF + R_GF d,      R_GM = R_GF Rx(α) Ry(β) Rz(γ)
///
/// With C the Jacobian of the mobile part's motion (CoG, angular) to the free rates s' and the bracket's modal rates
/// η', M its mass matrix, f what is applied to it with the gyroscopic moments, b its acceleration at s'' = 0, η'' = 0,
/// and e the modal accelerations that the fixed part alone would have, d'Alembert's principle gives
///
///     (Cᵀ M C + diag(0, I)) (s'', η'') = Cᵀ (f − M b) + (0, e)
///
/// so that guides without friction do no work and their reactions act on the bracket too.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/mount_forces.hpp"

namespace wems {

/// Linear first: (m, rad), (m/s, rad/s), (m/s², rad/s²), (N, N m).
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Coordinates s of M relative to F, and their rates. |β| < π/2.
Vector6 calcRelativeCoordinates(const BodyMotion& mobile, const FrameMotion& fixed);
Vector6 calcRelativeRates(const BodyMotion& mobile, const FrameMotion& fixed);

/// The inverse of both.
BodyMotion composeMotion(const FrameMotion& fixed, const Vector6& s, const Vector6& s_rate);

/// Velocity of M's origin and angular velocity (both in G, relative to F) = J s'.
Matrix6 calcRelativeJacobian(const Eigen::Matrix3d& R_GF, const Vector6& s);

/// Acceleration of M's origin and angular acceleration, in G.
/// @param frame_acceleration of F: linear, angular, in G
Vector6 composeAcceleration(const FrameMotion& fixed, const Vector6& frame_acceleration, const Vector6& s,
                            const Vector6& s_rate, const Vector6& s_acceleration);

/// Velocity of a point at `arm` (G) from F's origin, and angular velocity, = T (v_GF, w_GF).
Matrix6 calcTransport(const Eigen::Vector3d& arm);

class GuidedMotion {
public:
    explicit GuidedMotion(const MobileBody& body);

    /// False if all six motions are free: nothing of this is needed then.
    bool active() const { return !held_.empty(); }
    /// Indices into s.
    const std::vector<int>& free() const { return free_; }
    const std::vector<int>& held() const { return held_; }
    /// Whether the relative displacement of a connection along an axis of F, at that position in M, can be other than
    /// zero.
    bool moves(const Eigen::Vector3d& position, int axis) const;
    /// The free columns of a matrix with six.
    Eigen::MatrixXd freeColumns(const Eigen::MatrixXd& matrix) const;

    /// Sets the held coordinates and their rates to zero.
    void project(BodyMotion& mobile, const FrameMotion& fixed) const;

    /// Accelerations of the CoG and angular, in G, of the guided part.
    /// @param frame_bias acceleration of F: as prescribed, or at η'' = 0
    /// @param applied force and moment about the CoG, in G, that act on the part (gyroscopic moments left out)
    /// @param frame_jacobian (v_GF, w_GF) to η', 6 x modes; no columns if F's motion is prescribed
    /// @param[in,out] modal η'' without the guides' reactions; with them on return
    /// @param stabilization 1/s: held coordinates that are not zero decay at this rate; 0 where project() is used
    Vector6 calcAcceleration(const BodyMotion& mobile, const FrameMotion& fixed, const Vector6& frame_bias,
                             const Wrench& applied, const Eigen::MatrixXd& frame_jacobian,
                             Eigen::Ref<Eigen::VectorXd> modal, double stabilization) const;

private:
    MobileBody body_;
    std::vector<int> free_, held_;
};

}  // namespace wems
