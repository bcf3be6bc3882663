/// @file
/// Forces between the mobile and the fixed part from their motion: the one place where laws and kinematics of the
/// mount meet. Used by the Simbody force element, by the forward model and by the regression alike.
///
/// Relative displacement at connection i, in F axes (exact for large rotations):
///
///     q_i = R_GFᵀ [(p_GM + R_GM r_i) − (p_GF + R_GF r_i)]
///     v_i = dq_i/dt = R_GFᵀ [(v_GM + w_GM × R_GM r_i) − v_GF − w_GF × (p_GMi − p_GF)]
///
/// The force on the mobile part at its end p_GMi is −R_GF f(q_i, v_i); the fixed part gets the opposite at the same
/// point, so that total force and total moment vanish and the power of both is −Σ f·v.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "models/mount_model.hpp"

namespace wems {

// What the model says about the applied load: applied = gain(f) · axis_gain · recorded, f the swept frequency.

/// The gain (-) that all axes have in common at a swept frequency (Hz): linear between the rows of the table, constant
/// outside; a single row holds at every frequency, also where the frequency is not known (NaN). 1 if the table is
/// empty.
double calcLoadGain(const LoadCorrection& correction, double frequency);

/// The gain of each axis (-) at a swept frequency (Hz).
Eigen::Vector3d calcLoadGains(const LoadCorrection& correction, double frequency);

/// True if the gain depends on frequency, so that a swept frequency must be known.
bool dependsOnFrequency(const LoadCorrection& correction);

/// Pose and velocities of M in G.
struct BodyMotion {
    Eigen::Matrix3d R_GM = Eigen::Matrix3d::Identity();
    Eigen::Vector3d p_GM = Eigen::Vector3d::Zero();  ///< m, of M's origin
    Eigen::Vector3d w_GM = Eigen::Vector3d::Zero();  ///< rad/s, in G
    Eigen::Vector3d v_GM = Eigen::Vector3d::Zero();  ///< m/s, in G
};

/// Relative displacement and velocity at one connection, in F axes.
struct RelativeMotion {
    Eigen::Vector3d q, v;
};

RelativeMotion calcRelativeMotion(const BodyMotion& mobile, const FrameMotion& fixed, const Eigen::Vector3d& position);

class MountForces {
public:
    /// Takes laws and positions of the model's connections; does not keep a reference.
    explicit MountForces(const MountModel& model);

    int connectionCount() const { return static_cast<int>(positions_.size()); }
    int stateCount() const { return state_count_; }

    const AxisForce& axis(int connection, int axis_index) const;
    AxisForce& updAxis(int connection, int axis_index);  // state counts must not change

    /// First internal state of an axis.
    int stateOffset(int connection, int axis_index) const;

    /// Forces on both parts and the derivatives of the internal states.
    /// @param z stateCount() internal states, may be null if there are none.
    /// @param[out] zdot their derivatives, stateCount(); null if they are not wanted.
    /// @param[out] on_mobile at M's origin, in G; @param[out] on_fixed at F's origin, in G.
    void calc(const BodyMotion& mobile, const FrameMotion& fixed, double t, const double* z, Wrench& on_mobile,
              Wrench& on_fixed, double* zdot) const;

    /// Forces f of each connection (3 x connections, F axes, sign of q).
    Eigen::Matrix3Xd calcConnectionForces(const BodyMotion& mobile, const FrameMotion& fixed, double t,
                                          const double* z) const;

    double calcPotential(const BodyMotion& mobile, const FrameMotion& fixed, double t, const double* z) const;
    double calcDissipatedPower(const BodyMotion& mobile, const FrameMotion& fixed, double t, const double* z) const;

private:
    std::vector<Eigen::Vector3d> positions_;
    std::vector<AxisForce> axes_;  // 3 per connection
    std::vector<int> state_offsets_;
    int state_count_ = 0;
};

/// Static equilibrium under gravity: pose of M with F at its own static deflection (η with bracket), internal states
/// relaxed. Newton on the exact equations, gravity applied in steps where it does not converge at once. Throws
/// InputError if there is none.
struct StaticEquilibrium {
    BodyMotion mobile;       ///< at rest
    Eigen::VectorXd eta;     ///< bracket modes, empty without
    Eigen::VectorXd states;  ///< internal states of MountForces, relaxed
};
StaticEquilibrium findStaticEquilibrium(const MountModel& model);

// Where the recorded load acts.

/// Adds the load (N, in G) to the wrench on the part that it acts on, if there is a load point of the model's own.
/// @param[in,out] on_mobile at M's origin, @param[in,out] on_fixed at F's origin, in G
/// @return the load that is left for the bracket's load point
Eigen::Vector3d applyLoad(const std::optional<LoadPoint>& point, const BodyMotion& mobile, const FrameMotion& fixed,
                          const Eigen::Vector3d& load, Wrench& on_mobile, Wrench& on_fixed);

/// True if a recorded load moves something: it acts on the mobile part, or there is a bracket.
bool loadActs(const MountModel& model);

}  // namespace wems
