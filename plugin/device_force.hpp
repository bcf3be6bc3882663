/// @file
/// All that acts on the device: mount, flexible bracket, load, base acceleration, gravity, wheel.
///
/// The mobile part is one Simbody body; the bracket's modal coordinates η and their rates are z states of this element,
/// so that the fixed part costs no bodies. Ground is the base that carries the bracket; where the base accelerates,
/// the motion is written in the frame of the base and its inertia forces are added. On the mobile part act
///
///     the mount's wrench                              models/mount_forces.hpp, F moving as models/bracket.hpp says
///     m (g − a_base)                                  at the centre of gravity
///     −ω × R_GM h                                     a wheel with constant angular momentum h in M
///
/// and on the modes η'' + 2ζω η' + ω² η = Φᵀ (mount, load) − Pᵀ a_base. Shapes describe motion relative to the base.
///
/// Where the parts come more than 1 m apart, or the mobile part turns by more than 80 degrees about y (the mobilizer's
/// angles are singular at 90), no force is computed any more and the integration ends: see failure().
///
/// Energy: kinetic (the body) + calcPotentialEnergy (mount, gravity, and kinetic and elastic energy of the modes)
/// + getDissipatedEnergy is constant without load, base motion and drift.
#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

#include "models/mount_model.hpp"
#include "plugin/drive.hpp"
#include "plugin/simbody.hpp"

namespace wems::plugin {

/// Why no force is computed. Within a step the integrator answers with a shorter one, and keeps the reason from its
/// caller; where a sample is recorded, it reaches the caller as it is.
class DeviceFailure : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

class DeviceForce : public SimTK::Force::Custom {
public:
    DeviceForce() = default;
    /// @param mobile the mobile part; its body frame is M
    /// @param drive  may be null: no load, base at rest
    DeviceForce(SimTK::GeneralForceSubsystem& forces, const SimTK::MobilizedBody& mobile, const MountModel& model,
                std::shared_ptr<const Drive> drive);

    /// Replaces laws, bracket modes, gravity, spin and load correction by those of `model`; the body's mass properties
    /// belong to the topology and stay. Modal coordinates and internal states keep their values.
    /// @throws InputError if the number of connections, internal states or modes is another.
    void setModel(SimTK::State& state, const MountModel& model) const;

    int modeCount() const;
    /// Modal coordinates, their rates, and (Stage::Acceleration) accelerations.
    Eigen::VectorXd getEta(const SimTK::State& state) const;
    Eigen::VectorXd getEtaDot(const SimTK::State& state) const;
    Eigen::VectorXd getEtaDotDot(const SimTK::State& state) const;
    void setEta(SimTK::State& state, const Eigen::VectorXd& eta, const Eigen::VectorXd& eta_dot) const;
    /// Internal states of the laws.
    void setInternalStates(SimTK::State& state, const Eigen::VectorXd& states) const;

    /// Motion of F, and its acceleration (Stage::Acceleration), relative to the base.
    FrameMotion calcFixedMotion(const SimTK::State& state) const;
    Bracket::FrameAcceleration calcFixedAcceleration(const SimTK::State& state) const;

    /// Forces f of each connection, F axes, sign of q: 3 x connections, N.
    Eigen::Matrix3Xd calcConnectionForces(const SimTK::State& state) const;

    /// J, from the start.
    double getDissipatedEnergy(const SimTK::State& state) const;

    /// Called now and then with the time of the force that is computed, s; a text that it returns is the failure() of
    /// this and of all later forces.
    void setWatch(std::function<std::string(double)> watch) const;

    /// Why the forces could not be computed, last time; empty if they always could. Simbody itself tells no reason.
    const std::string& failure() const;
};

}  // namespace wems::plugin
