/// @file
/// The flexible bracket as a modal surrogate: normal modes of the fixed part without the mobile part.
///
/// Modal coordinates η (kg^1/2 m) obey η_j'' + 2 ζ_j ω_j η_j' + ω_j² η_j = φ_jᵀ w, with w the forces on the fixed part,
/// each at its own point. The fixed part's frame F moves rigidly with
///
///     p_GF = Φ_u η,   R_GF = exp([Φ_r η]×),   w_GF = B(θ) Φ_r η',   θ = Φ_r η,
///
/// B the left Jacobian of SO(3), and the modal force of a wrench (moment M about Fo, force f) is Φ_uᵀ f + (B Φ_r)ᵀ M,
/// so that the power of the wrench equals the power of the modal forces exactly, not to first order only.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "models/tolerances.hpp"

namespace wems {

/// One row of the modes file. Shapes are mass-normalised: displacement = shape · modal coordinate.
struct BracketMode {
    double frequency = 0;                                        ///< Hz, > 0
    double damping_ratio = 0;                                    ///< -, ≥ 0
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();       ///< ux uy uz at the interface, kg^-1/2
    Eigen::Vector3d rotation = Eigen::Vector3d::Zero();          ///< rx ry rz at the interface, kg^-1/2 m^-1
    Eigen::Vector3d load_translation = Eigen::Vector3d::Zero();  ///< at the load point, kg^-1/2
    Eigen::Vector3d base_participation =
        Eigen::Vector3d::Zero();  ///< φᵀ M r for base motion, kg^1/2; optional columns base.ux…
    Tolerances tolerances = {};   ///< mode_frequency, mode_damping_ratio, mode_shape of this mode alone
};

/// Pose and velocities of the fixed part's frame F in G. Rotation is a proper rotation matrix.
struct FrameMotion {
    Eigen::Matrix3d R_GF = Eigen::Matrix3d::Identity();
    Eigen::Vector3d p_GF = Eigen::Vector3d::Zero();  ///< m
    Eigen::Vector3d w_GF = Eigen::Vector3d::Zero();  ///< rad/s, in G
    Eigen::Vector3d v_GF = Eigen::Vector3d::Zero();  ///< m/s, in G
};

/// A force at F's origin and a moment about it, in G.
struct Wrench {
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();  ///< N m
    Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< N
};

/// The modes, prepared for evaluation.
class Bracket {
public:
    explicit Bracket(std::vector<BracketMode> modes);

    int modeCount() const { return static_cast<int>(modes_.size()); }
    const std::vector<BracketMode>& modes() const { return modes_; }

    /// Motion of F from η and η' (modeCount() each).
    FrameMotion calcMotion(const Eigen::Ref<const Eigen::VectorXd>& eta,
                           const Eigen::Ref<const Eigen::VectorXd>& eta_dot) const;

    /// The same with what the accelerations need too, so that a right-hand side computes it once.
    struct Kinematics {
        FrameMotion motion;
        Eigen::Matrix3d jacobian;  ///< B(θ)
    };
    Kinematics calcKinematics(const Eigen::Ref<const Eigen::VectorXd>& eta,
                              const Eigen::Ref<const Eigen::VectorXd>& eta_dot) const;

    /// Acceleration of F's origin (m/s²) and angular acceleration (rad/s²), in G.
    struct FrameAcceleration {
        Eigen::Vector3d angular, linear;
    };
    FrameAcceleration calcAcceleration(const Eigen::Ref<const Eigen::VectorXd>& eta,
                                       const Eigen::Ref<const Eigen::VectorXd>& eta_dot,
                                       const Eigen::Ref<const Eigen::VectorXd>& eta_dot_dot) const;

    /// (v_GF, w_GF) = J η', 6 x modes, with B(θ) known from calcKinematics.
    Eigen::MatrixXd calcFrameJacobian(const Eigen::Matrix3d& jacobian) const;

    /// η'' under a wrench at Fo, a force at the load point, and a base acceleration (all in G).
    void calcAccelerations(const Eigen::Ref<const Eigen::VectorXd>& eta,
                           const Eigen::Ref<const Eigen::VectorXd>& eta_dot, const Wrench& at_interface,
                           const Eigen::Vector3d& load, const Eigen::Vector3d& base_acceleration,
                           Eigen::Ref<Eigen::VectorXd> eta_dot_dot) const;
    /// The same with B(θ) known from calcKinematics.
    void calcAccelerations(const Eigen::Matrix3d& jacobian, const Eigen::Ref<const Eigen::VectorXd>& eta,
                           const Eigen::Ref<const Eigen::VectorXd>& eta_dot, const Wrench& at_interface,
                           const Eigen::Vector3d& load, const Eigen::Vector3d& base_acceleration,
                           Eigen::Ref<Eigen::VectorXd> eta_dot_dot) const;

    /// Kinetic plus elastic energy (J), and the power lost in the modal dampers (W).
    double calcEnergy(const Eigen::Ref<const Eigen::VectorXd>& eta,
                      const Eigen::Ref<const Eigen::VectorXd>& eta_dot) const;
    double calcDissipatedPower(const Eigen::Ref<const Eigen::VectorXd>& eta_dot) const;

private:
    std::vector<BracketMode> modes_;
    Eigen::Matrix3Xd translation_, rotation_, load_, base_;  // 3 x modes
    Eigen::VectorXd omega_squared_, two_zeta_omega_;
};

/// Reads the modes CSV (header `frequency [Hz],damping_ratio,ux,uy,uz,rx,ry,rz,load.ux,load.uy,load.uz`, optionally
/// `base.ux,base.uy,base.uz`). Throws InputError with file and line.
std::vector<BracketMode> readBracketModes(const std::string& file);
/// The same from text; `file` is for messages.
std::vector<BracketMode> parseBracketModes(std::string_view text, const std::string& file);

// The modes file as text; reading it is in models/bracket.hpp.

/// The text of a modes file that reads back to the same modes; base columns only where a mode has some.
std::string formatBracketModes(const std::vector<BracketMode>& modes);

}  // namespace wems
