/// @file
/// One number that a fit may turn: a parameter of the model, or several that move together.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "models/mount_model.hpp"

namespace wems::identify {

/// The named parameters (models/parameter_access.hpp) all take the knob's value, or, if `base` is not empty, the
/// knob's value times their base values (a common factor).
struct Knob {
    /// The load point of a bracket mode moves rigidly with the interface, whatever a knob makes of the shape there.
    struct RigidLoadPoint {
        std::size_t mode;          ///< from 0
        Eigen::Vector3d position;  ///< m, from F's origin
    };

    std::vector<std::string> names;
    std::vector<double> base;
    std::optional<RigidLoadPoint> load_point = std::nullopt;

    bool isFactor() const { return !base.empty(); }
    double get(const MountModel& model) const;
    void set(MountModel& model, double value) const;
    /// Magnitude at which it matters, for finite differences.
    double scale(const MountModel& model) const;
    /// Physical range of the parameter (stiffness not negative, …); of a factor 0 … ∞.
    double lowest(const MountModel& model) const;
    double highest(const MountModel& model) const;
};

Knob makeKnob(const std::string& name);
/// One value for all.
Knob makeSharedKnob(std::vector<std::string> names);
/// One factor for all, on the values that `model` has; those that are zero are left out.
Knob makeFactorKnob(const MountModel& model, const std::vector<std::string>& names);

}  // namespace wems::identify
