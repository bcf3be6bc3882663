/// @file
/// The mount as a Simbody force element between any two bodies.
///
/// A frame F sits on the "fixed" body, a frame M on the mobile body; they coincide when the mount is at rest. Between
/// them act the connections of a MountModel, each with three axis laws (models/axis_law.hpp) along the axes of F:
///
///     q_i = R_GFᵀ [(p_GM + R_GM r_i) − (p_GF + R_GF r_i)]       relative displacement, m, exact for large rotations
///     force on the mobile body = −R_GF f(q_i, q_i')             at its end of the connection
///
/// The fixed body gets the opposite at the same point, so that total force and total moment are zero and the element
/// neither depends on where the world's axes point nor on which body moves. The model's body, bracket, gravity, load
/// and sensors play no role here: the bodies are yours.
///
/// State variables: internal states of the laws (Maxwell branches, friction, hysteresis) and the dissipated energy, all
/// z; the laws themselves are a discrete variable (setLaws), so that stiffness, clearance and the like change in a
/// given State without new topology. Kinetic + calcPotentialEnergy + calcDissipatedEnergy is constant where nothing
/// else acts and no stiffness drifts.
///
/// Use (see also tests/consumer):
/// @code
///   wems::plugin::MountForce mount(forces, base, X_BaseF, device, X_DeviceM, wems::readMountModel("mount.toml"));
///   State state = system.realizeTopology();
/// @endcode
#pragma once

#include <utility>
#include <vector>

#include "models/mount_forces.hpp"
#include "models/mount_model.hpp"
#include "plugin/simbody.hpp"

namespace wems::plugin {

// State variables of a force element: its own first-order states and its values, kept in the Simbody state.

/// What a force element needs beside the formula for its force:
/// - `count` continuous states z with derivatives, integrated together with the bodies;
/// - a value of type `Values` (stiffnesses, clearances, …) as a discrete state variable. Changing it invalidates
///   Stage::Dynamics and nothing before, so that no topology is built anew between two parameter sets.
/// The derivatives are computed together with the force, at Stage::Dynamics, and handed to the state at
/// Stage::Acceleration, where Simbody wants them.
template <class Values>
class ElementState {
public:
    ElementState(const SimTK::GeneralForceSubsystem& forces, Values defaults, int count)
        : forces_(forces), defaults_(std::move(defaults)), count_(count) {}

    int count() const { return count_; }
    const Values& defaults() const { return defaults_; }

    /// Allocates the variables; call from realizeTopology().
    void allocate(SimTK::State& state) const {
        z_ = forces_.allocateZ(state, SimTK::Vector(count_, 0.0));
        values_ = forces_.allocateDiscreteVariable(state, SimTK::Stage::Dynamics, new SimTK::Value<Values>(defaults_));
        derivatives_ = forces_.allocateCacheEntry(state, SimTK::Stage::Dynamics, SimTK::Stage::Infinity,
                                                  new SimTK::Value<SimTK::Vector>(SimTK::Vector(count_, 0.0)));
    }

    const double* getZ(const SimTK::State& state) const { return &forces_.getZ(state)[z_]; }
    double* updZ(SimTK::State& state) const { return &forces_.updZ(state)[z_]; }
    /// Needs Stage::Acceleration.
    const double* getZDot(const SimTK::State& state) const { return &forces_.getZDot(state)[z_]; }

    const Values& getValues(const SimTK::State& state) const {
        return SimTK::Value<Values>::downcast(forces_.getDiscreteVariable(state, values_)).get();
    }
    Values& updValues(SimTK::State& state) const {
        return SimTK::Value<Values>::updDowncast(forces_.updDiscreteVariable(state, values_)).upd();
    }

    /// Where calcForce() puts the derivatives of z.
    double* updDerivatives(const SimTK::State& state) const {
        return &SimTK::Value<SimTK::Vector>::updDowncast(forces_.updCacheEntry(state, derivatives_)).upd()[0];
    }
    /// Call at the end of calcForce().
    void markDerivatives(const SimTK::State& state) const { forces_.markCacheValueRealized(state, derivatives_); }
    /// Call from realizeAcceleration().
    void publishDerivatives(const SimTK::State& state) const {
        const SimTK::Vector& derivatives =
            SimTK::Value<SimTK::Vector>::downcast(forces_.getCacheEntry(state, derivatives_)).get();
        double* zdot = &forces_.updZDot(state)[z_];
        for (int i = 0; i < count_; ++i) zdot[i] = derivatives[i];
    }

private:
    const SimTK::GeneralForceSubsystem& forces_;
    Values defaults_;
    int count_;
    // Simbody builds the topology of an otherwise constant element and tells it here where its variables are.
    mutable SimTK::ZIndex z_;
    mutable SimTK::DiscreteVariableIndex values_;
    mutable SimTK::CacheEntryIndex derivatives_;
};

class MountForce : public SimTK::Force::Custom {
public:
    /// Empty handle.
    MountForce() = default;

    /// @param X_FixedF pose of the mount frame on the fixed body, in that body's frame (Ground is a body too)
    /// @param X_MobileM pose of the mount frame on the mobile body, in that body's frame
    /// @throws InputError if a law of the model cannot be used.
    MountForce(SimTK::GeneralForceSubsystem& forces, const SimTK::MobilizedBody& fixed,
               const SimTK::Transform& X_FixedF, const SimTK::MobilizedBody& mobile, const SimTK::Transform& X_MobileM,
               const MountModel& model);

    int connectionCount() const;

    /// Laws in force in this state.
    const MountForces& getLaws(const SimTK::State& state) const;
    /// Replaces all laws by those of `model`; internal states keep their values.
    /// @throws InputError if `model` has other connections or another number of internal states.
    void setLaws(SimTK::State& state, const MountModel& model) const;

    /// Relative displacement (m) and velocity (m/s) of each connection, in F axes. Needs Stage::Velocity.
    std::vector<RelativeMotion> calcRelativeMotions(const SimTK::State& state) const;
    /// Forces f of each connection (N, 3 x connections, F axes, sign of q). Needs Stage::Velocity.
    Eigen::Matrix3Xd calcConnectionForces(const SimTK::State& state) const;

    /// J, since it was last set; zero at first.
    double getDissipatedEnergy(const SimTK::State& state) const;
    void setDissipatedEnergy(SimTK::State& state, double energy) const;
    /// W. Needs Stage::Velocity.
    double calcDissipatedPower(const SimTK::State& state) const;
};

}  // namespace wems::plugin
