/// @file
/// `diagnose` of a rig that moves along one axis, by its free response (rig_problem.hpp).
#pragma once

#include <optional>
#include <vector>

#include "identify/diagnose/diagnosis.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

/// Nothing if the device is no such rig, or its runs say too little by themselves: no displacement or acceleration of
/// the mobile part along the axis.
std::optional<Diagnosis> diagnoseRig(const std::vector<Recording>& identification,
                                     const std::vector<Recording>& validation, const MountModel& model,
                                     const DiagnosisOptions& options);

}  // namespace wems::identify
