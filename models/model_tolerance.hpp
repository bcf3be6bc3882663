/// @file
/// The tolerance that holds for an item or a parameter of a model: the item's own, else the model's, else the default.
#pragma once

#include <optional>
#include <string>

#include "models/mount_model.hpp"

namespace wems {

/// In the unit of the key (relative ones as a fraction). `item` is the `tolerances` member of what it is about: the
/// body, a connection (position), one of its axes (`axis_tolerances`), a bracket mode, what sensorTolerances() returns.
double toleranceOf(const MountModel& model, ToleranceOf what, const Tolerances& item = {});

/// Whether a model states that all of its numbers, and those of its sensors, are exactly known: every tolerance 0,
/// those of single items too.
bool isExactlyKnown(const MountModel& model);

/// What the [[sensor]] tables give for a channel (`mobile.1.az`) or a group of them (`mobile.1`); where several concern
/// it, the longest name wins, key by key.
Tolerances sensorTolerances(const MountModel& model, const std::string& channel);

/// Half-width of a parameter in its own SI unit, ≥ 0: relative tolerances times the magnitude of the present value.
/// nullopt of what has none: mechanisms (cubic, friction …), the wheel, offsets, stops that are not there.
/// @param name as in models/parameter_access.hpp
/// @throws InputError if the model has no such parameter
std::optional<double> parameterTolerance(const MountModel& model, const std::string& name);

}  // namespace wems
