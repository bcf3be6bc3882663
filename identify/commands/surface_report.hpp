/// @file
/// The pictures of a restoring force surface, also those in three dimensions that other reports show.
#pragma once

#include <string>

#include "identify/component/component_data.hpp"
#include "identify/component/surface_kind.hpp"
#include "models/atomic_file.hpp"
#include "models/report/force_surface.hpp"

namespace wems::identify::commands {

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

}  // namespace wems::identify::commands
