/// @file
/// The causes that a diagnosis considers, each at every place where it may act in a given model.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/mount_model.hpp"

namespace wems::identify {

// One number that a fit may turn: a parameter of the model, or several that move together.

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

/// One cause at one place (or at several together).
struct Candidate {
    std::string cause;               ///< `cog_offset`, …
    std::vector<std::string> where;  ///< `body`, `4.z`, `4.z.+`, `bracket`, `load`
    std::vector<Knob> knobs;         ///< what is fitted
    /// Set before fitting, such as a clearance to infinity for a stop too many.
    std::vector<std::pair<std::string, double>> fixed;
    /// Trial values of the knobs, one row for each start. The screening tells how far along the way from the present
    /// value to the trial value the data want to go, for all knobs up to `linear`; the others keep the trial value.
    std::vector<std::vector<double>> starts;
    std::size_t linear = 1;  ///< 0: the trial values are taken as they are
    /// A row that the modes file lacks: where the model has fewer rows, apply() appends it (with rows that nothing
    /// drives before it, should any be missing there), before the knobs are set.
    struct NewMode {
        int row;  ///< from 1
        BracketMode mode;
    };
    std::optional<NewMode> new_mode = std::nullopt;

    /// Names of all parameters in the result.
    std::vector<std::string> parameterNames() const;
    /// `friction 1.x` for messages.
    std::string describe() const;
    void apply(MountModel& model, const std::vector<double>& values) const;
};

/// Everything in the catalogue that the model as it is now may lack. Bracket modes and load are left out unless the
/// recordings show them (`with_bracket`).
std::vector<Candidate> makeCatalogue(const MountModel& model, bool with_bracket);

}  // namespace wems::identify
