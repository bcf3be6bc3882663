/// @file
/// The whole device as a Simbody system: one body on a six-degree-of-freedom mobilizer and one force element.
#pragma once

#include <memory>
#include <vector>

#include "models/mount_model.hpp"
#include "plugin/base_motion.hpp"
#include "plugin/device_force.hpp"
#include "plugin/drive.hpp"
#include "plugin/simbody.hpp"

namespace wems::plugin {

/// Motion of a material point in ground axes. Ground coincides with the mount axes at rest; the base's own motion is
/// included.
struct PointMotion {
    Eigen::Vector3d displacement;  ///< m, from the static equilibrium
    Eigen::Vector3d velocity;      ///< m/s
    Eigen::Vector3d acceleration;  ///< m/s²
};

/// What sensors could see at one instant.
struct DeviceMotion {
    std::vector<PointMotion> mobile, fixed;  ///< both ends of each connection
    std::vector<RelativeMotion> relative;    ///< of each connection, F axes
    Eigen::Matrix3Xd force;                  ///< N, of each connection, F axes, sign of the relative displacement
    Eigen::Vector3d load;                    ///< N, as commanded or recorded (the model's load correction not applied)
    Eigen::Vector3d base;                    ///< m/s²
    /// Origin (m) and rotation vector (rad) of both frames in ground axes, from rest.
    Eigen::Matrix<double, 6, 1> mobile_pose, fixed_pose;
};

/// Mobilizer coordinates are q = (α, β, γ, x, y, z): Bryant angles of M and position of its origin in ground axes.
/// Held motions of the mobile part are constraints; on a bracket, which is no Simbody body, reactions of the guides.
/// One Device must not be used by two threads at a time (Simbody 3.7 is not safe there); make one for each.
class Device {
public:
    /// @param drive may be null: no excitation
    /// @param duration s, over which the base motion is balanced; at most the drive's own
    /// @throws InputError if the model cannot be simulated or has no static equilibrium.
    Device(const MountModel& model, std::shared_ptr<const Drive> drive, double duration);
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
    ~Device() = default;

    const MountModel& model() const { return model_; }
    const DeviceForce& force() const { return force_; }
    const SimTK::MobilizedBody::Bushing& body() const { return body_; }
    const SimTK::MultibodySystem& system() const { return system_; }
    /// For event reporters, which must be added before makeRestState().
    SimTK::MultibodySystem& updSystem() { return system_; }

    /// Builds the topology and returns the static equilibrium under gravity at t = 0.
    SimTK::State makeRestState();

    /// Realizes `state` to Stage::Acceleration.
    DeviceMotion calcMotion(const SimTK::State& state) const;
    /// Kinetic, potential, modal and dissipated energy, J; realizes `state` to Stage::Dynamics.
    double calcTotalEnergy(const SimTK::State& state) const;

private:
    MountModel model_;
    std::shared_ptr<const Drive> drive_;
    StaticEquilibrium rest_;
    FrameMotion rest_fixed_;
    std::unique_ptr<BaseMotion> base_motion_;
    SimTK::MultibodySystem system_;
    SimTK::SimbodyMatterSubsystem matter_;
    SimTK::GeneralForceSubsystem forces_;
    SimTK::MobilizedBody::Bushing body_;
    DeviceForce force_;
};

}  // namespace wems::plugin
