/// @file
/// Restoring forces of the connections in the reports of a fit and a diagnosis: what the equations of motion demand
/// along the measured motion, against what the model's laws give, before and after.
///
/// The mobile part has six equations, its connections have more axes. The force that is drawn as measured at an axis is
/// the one that the equations demand of it if every other axis follows its law (a partial residual):
///
///     f_measured = f_law − dᵀ W r / (dᵀ W d)
///
/// with r the residual wrench of the model, d the axis' direction in it and W the inverse covariance of the wrench that
/// the channels' noise gives.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "identify/commands/judged_runs.hpp"
#include "identify/motion/swept_frequency.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::commands {

/// A measured motion, its slow part included, and what drove it.
struct MovedRun {
    const RunMotion* motion = nullptr;
    SweptFrequency swept;
};

/// Curves of all axes, the named one's loops at its largest motion and its surface over displacement and velocity.
/// @param after_is `as extended`, `as fitted`
/// @param named    whose surface is drawn; absent: the axis with the largest force
void addRestoringForces(HtmlReport& page, const std::vector<MovedRun>& runs, const MountModel& before,
                        const MountModel& after, const std::string& after_is, const std::optional<AxisPlace>& named);

}  // namespace wems::identify::commands
