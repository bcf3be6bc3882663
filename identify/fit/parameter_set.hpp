/// @file
/// The parameters of a mount model that a fit may free; names and values as in models/parameter_access.hpp.
#pragma once

#include <string>
#include <vector>

#include "models/mount_model.hpp"

namespace wems::identify {

enum class ParameterKind {
    stiffness,
    damping,
    stop_stiffness,
    clearance,
    center_of_gravity,
    inertia,
    other  ///< any number by its name; of fits to simulations alone (output_error.hpp)
};

struct Parameter {
    ParameterKind kind = ParameterKind::stiffness;
    std::string name;     ///< `1.z.stiffness`, `4.z.+.clearance`, `1.x.damping`, `body.center_of_gravity.z`
    std::string unit;     ///< SI
    int connection = -1;  ///< -1 for the body
    int axis = -1;  ///< 0 x, 1 y, 2 z; of the centre of gravity its component, of the inertia 0 … 5: xx yy zz xy xz yz
    int stop = -1;  ///< index in AxisLaw::stops
};

/// Stiffness and damping of every axis that has stiffness, stiffness and clearance of every stop (the first on each
/// side; a further one is taken as known), and what `free_body` names: `body.center_of_gravity`, `body.inertia`, or one
/// component of them such as `body.center_of_gravity.z`.
/// @throws InputError on a name that cannot be freed, listing those that can.
std::vector<Parameter> makeParameters(const MountModel& model, const std::vector<std::string>& free_body);

/// The same, and any number of the model that `free` names (models/parameter_access.hpp).
/// @throws InputError on a name of nothing
std::vector<Parameter> makeAnyParameters(const MountModel& model, const std::vector<std::string>& free);

/// What the value is measured against when asking whether it is known: its own size, or for one that may be zero
/// (damping, centre of gravity, products of inertia) that of its kind in this model. Always > 0.
double calcScale(const MountModel& model, const Parameter& parameter);

/// Name of an axis such as `4.z`.
std::string formatAxisName(const MountModel& model, int connection, int axis);

}  // namespace wems::identify
