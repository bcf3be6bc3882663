/// @file
/// State variables of a force element: its own first-order states and its values, kept in the Simbody state.
#pragma once

#include <utility>

#include "plugin/simbody.hpp"

namespace wems::plugin {

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

}  // namespace wems::plugin
