/// @file
/// Ends of the mobile part as functions of its six coordinates, and their Jacobian.
///
///     r_i(q) = p_CoG + R(α, β, γ) (X_i − c),   R = Rx(α) Ry(β) Rz(γ),   q = (p_CoG, α, β, γ)
///
/// X_i position of end i and c centre of gravity, both in the mobile frame. With ω = N(α, β) (α', β', γ'),
///
///     ∂r_i/∂q = [ I   −[R (X_i − c)]× N ]
///
/// J is 3n x 6 (12 x 6 for the cross). Its transpose maps forces at the ends to generalised forces, fᵀ ẋ = (Jᵀf)ᵀ q̇.
/// For ends that are not on one line it has rank 6 but at β = ±π/2, where N is singular: angle rates do not span the
/// angular velocities there.
#pragma once

#include <Eigen/Core>

namespace wems::identify {

using Coordinates = Eigen::Matrix<double, 6, 1>;  ///< p_CoG (m), α β γ (rad)

class MobileJacobian {
public:
    /// @param ends X_i, 3 x n, m; @param center_of_gravity c, m; both in the mobile frame
    MobileJacobian(const Eigen::Matrix3Xd& ends, const Eigen::Vector3d& center_of_gravity);

    /// r_i, 3 x n, m, in G.
    Eigen::Matrix3Xd calcPositions(const Coordinates& q) const;

    /// J, 3n x 6, rows in the order x, y, z of end 1, then of end 2 …
    Eigen::Matrix<double, Eigen::Dynamic, 6> calcJacobian(const Coordinates& q) const;

    /// The same towards (v_CoG, ω) in place of q̇: 3n x 6, regular everywhere.
    Eigen::Matrix<double, Eigen::Dynamic, 6> calcVelocityJacobian(const Coordinates& q) const;

    /// Force (N) and moment about the CoG (N m), both in G, that do the same work as the generalised forces Q = Jᵀ f:
    /// (F, N⁻ᵀ Q_angles).
    /// @throws std::domain_error at β = ±π/2, where generalised forces do not determine the moment.
    Coordinates calcWrench(const Coordinates& q, const Coordinates& generalized_forces) const;

private:
    Eigen::Matrix3Xd arms_;  // X_i − c
};

}  // namespace wems::identify
