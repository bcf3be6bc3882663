/// @file
/// `diagnose` of component tests: what a model's law has wrong or lacks, against the force measured on a test machine.
///
/// The believed law is judged along the measured motion, then refitted in its own shape (component_fit.hpp) and with
/// the parts of a law with memory (law_selection.hpp). Numbers off by less than their tolerance are adjustments; beyond
/// it, and parts that the model lacks, are causes. Errors are root relative squared errors of the force; a constant
/// force (zero of the load cell, weight) is never counted.
#pragma once

#include <vector>

#include "identify/component/component_data.hpp"
#include "identify/diagnose/diagnosis.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

/// @param validation judges; empty: the identification tests do, which the result says (`validated`)
/// @throws InputError as fitComponent
Diagnosis diagnoseComponent(const std::vector<Recording>& identification, const std::vector<Recording>& validation,
                            const MountModel& model, ComponentOptions options);

}  // namespace wems::identify
