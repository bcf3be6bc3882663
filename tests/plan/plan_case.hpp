/// @file
/// A device drawn at random with recordings that leave something open, and what became of the run that a plan proposes.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "identify/plan/plan.hpp"

namespace wems::identify::testing {

struct PlanCase {
    std::string kind;            ///< what the recordings lack
    MountModel truth, believed;  ///< stiffness, damping, clearance and stops of the second are off by up to 10 %
    std::vector<Recording> recordings;
    PlanOptions options;
    double noise = 0;  ///< m, of each displacement channel
};

/// One sweep of a device of random kind: along z alone, along x or y alone, or too low for any stop.
PlanCase drawPlanCase(std::mt19937_64& random);

/// What the best proposal promised, and what the run gave.
struct PlanOutcome {
    bool proposed = false;  ///< some group was promised to be separated, or a direction to become known
    std::size_t promised = 0, separated = 0;  ///< groups
    /// Promised over obtained width, of all that both know: those that the plan says to be known within a factor
    /// of 1.5, and the others.
    std::vector<double> width_ratios, wide_width_ratios;
};

/// Makes the best proposal's run of the true device with noise of its own, and fits all runs from the believed model.
PlanOutcome tryBestProposal(const PlanCase& drawn, const Plan& plan, std::mt19937_64& random);

std::vector<RunMotion> measureAll(const std::vector<Recording>& recordings, const MountModel& model);

}  // namespace wems::identify::testing
