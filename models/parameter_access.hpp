/// @file
/// Every parameter of a mount model by its name, as results and intervals name it.
///
///     1.z.stiffness  1.z.damping  1.z.offset  1.z.loss_factor  1.z.drift                   connection.axis.parameter
///     1.z.quadratic  1.z.cubic
///     1.z.stiffness_ratio  1.z.time_constant  1.z.friction_force  1.z.transition_velocity
///     1.z.presliding_stiffness
///     1.z.hysteresis_force  1.z.yield_displacement  1.z.exponent  1.z.shape
///     1.z.dissipation                                    χ of all stops of that axis
///     4.z.+.clearance  4.z.+.stiffness  4.z.+.dissipation                                  connection.axis.side
///     body.mass  body.center_of_gravity.x  body.inertia.Ixx … Iyz  body.spin.x
///     3.frequency  3.damping_ratio                       bracket mode, row of the modes file from 1
///     3.ux … 3.rz  3.load.ux … 3.base.uz                 its mass-normalised shape, as the modes file names it
///     load.gain, load.gain.x
///     mobile.1.az.gain  mobile.1.az.delay  mobile.1.rx   sensor of a channel, a triax (`mobile.1`) or a side
///     mobile.1.z.zero  load.fz.zero                      what one channel reads of nothing
///
/// All values in SI units. A stop that is not there has an infinite clearance, and setting an infinite clearance
/// removes the stop: a stop that is missing and one too many are thus values like any other.
#pragma once

#include <string>

#include "models/mount_model.hpp"

namespace wems {

/// Value of a parameter. Mechanisms that the model does not have return the value that they have no effect with (zero
/// force, unit gain, infinite clearance).
/// @throws InputError if the model has no such connection, mode or parameter name.
double getParameter(const MountModel& model, const std::string& name);

/// Sets a parameter, creating the mechanism (relaxation, friction, stop, sensor, load correction) where it is absent:
/// a new relaxation has a time constant of 10 ms, a new friction a transition velocity of 1 mm/s, a new
/// hysteresis a yield displacement of 0.1 mm, a new stop the stiffness of the model's other stops (10 times the
/// elastomer's if there are none). A `load.gain` replaces a table.
/// @throws InputError as getParameter; ranges are left to validate().
void setParameter(MountModel& model, const std::string& name, double value);

/// `N/m`, `-`, … of a parameter.
std::string parameterUnit(const std::string& name);

/// A positive magnitude at which the parameter matters: its own value where that is not zero, otherwise one that
/// follows from the model's stiffness, inertia and clearances. A finite difference takes a small fraction of it.
double parameterScale(const MountModel& model, const std::string& name);

/// The inertia about the CoG as six names: Ixx Iyy Izz Ixy Ixz Iyz.
inline constexpr const char* kInertiaNames[6] = {"Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz"};

}  // namespace wems
