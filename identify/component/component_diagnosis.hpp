/// @file
/// `diagnose` of component tests: what a model's law has wrong or lacks, against the force measured on a test machine.
///
/// Errors are root relative squared errors of the force along the measured motion (element_problem.hpp). Numbers off by
/// less than their tolerance are adjustments; beyond it, and mechanisms that the law lacks, are causes
/// (element_search.hpp). Where these leave too much, laws with distributions of sliders and branches are tried
/// (law_selection.hpp); what none of them takes away is unexplained.
#pragma once

#include <vector>

#include "identify/component/component_data.hpp"
#include "identify/diagnose/diagnosis.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

/// @param validation judges; empty: the identification tests do, which the result says (`validated`)
/// @throws InputError as extractComponent, or if nothing moves
Diagnosis diagnoseComponent(const std::vector<Recording>& identification, const std::vector<Recording>& validation,
                            const MountModel& model, ComponentOptions options, const DiagnosisOptions& progress);

}  // namespace wems::identify
