/// @file
/// `diagnose` of component tests: what a model's law has wrong or lacks, against the force measured on a test machine.
///
/// Errors are root relative squared errors of the force along the measured motion (element_problem.hpp). Numbers off by
/// less than their tolerance are adjustments; beyond it, and mechanisms that the law lacks, are causes
/// (element_search.hpp). Where these leave too much, laws with distributions of sliders and branches are tried
/// (below); what none of them takes away is unexplained.
#pragma once

#include <string>
#include <vector>

#include "identify/component/component_data.hpp"
#include "identify/component/law_fit.hpp"
#include "identify/component/surface.hpp"
#include "identify/verdict/diagnosis.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

// Which law a component test shows: all combinations of parts that a mount's law may have, fitted to all tests
// together, and the simplest of those that the tests cannot tell apart.

struct LawSelection {
    std::vector<LawFit> tried;        ///< in order of complexity
    std::vector<double> information;  ///< Bayesian criterion of each, with the samples of the closest law's remainder
    std::size_t chosen = 0;

    const LawFit& law() const { return tried[chosen]; }
};

/// The simplest law whose criterion is within 6 of the best (a factor 20 in odds, Kass and Raftery 1995).
LawSelection selectLaw(const std::vector<ComponentData>& tests, const std::vector<Stop>& stops);

/// The kind of a surface where laws with memory were tried, too: `hysteresis`, `friction with gap at reversals` or
/// `viscoelastic` where such a law leaves less than half of what the laws of displacement and velocity leave;
/// `unexplained` where all of them leave more than 30 % of the force: then no law has been found, and none is named.
SurfaceKind nameByMemory(SurfaceKind kind, const LawSelection& laws);

/// @param validation judges; empty: the identification tests do, which the result says (`validated`)
/// @throws InputError as extractComponent, or if nothing moves
Diagnosis diagnoseComponent(const std::vector<Recording>& identification, const std::vector<Recording>& validation,
                            const MountModel& model, ComponentOptions options, const DiagnosisOptions& progress);

}  // namespace wems::identify
