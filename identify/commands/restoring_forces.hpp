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

#include "identify/commands/run_pictures.hpp"
#include "identify/component/component_data.hpp"
#include "identify/component/surface.hpp"
#include "identify/motion/swept_frequency.hpp"
#include "models/common/atomic_file.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::commands {

// The pictures of a restoring force surface, also those in three dimensions that other reports show.

/// Displacement in mm, velocity in m/s, force in N; no sheet yet.
ForceSurface makeEmptySurface(const std::string& title);

/// Medians of f over cells of (q, v), as many cells as the samples fill. All sheets of a surface must have the same q
/// and v.
/// @param points a point for each cell in place of a sheet
void addSheet(ForceSurface& surface, const std::string& name, const ComponentData& data, bool points, int color);

/// Writes a page with the kind, its parameters, force over displacement and velocity, both slices and the force over
/// the travel since the last reversal. @throws InputError if the file cannot be written.
void writeSurfaceReport(const ComponentData& data, const SurfaceKind& kind, const std::string& file,
                        OutputFiles& outputs);

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
