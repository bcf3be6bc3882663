/// @file
/// Restoring force surfaces of recordings as reports show them in three dimensions.
#pragma once

#include <string>

#include "identify/component/component_data.hpp"
#include "models/report/force_surface.hpp"

namespace wems::identify::commands {

/// Displacement in mm, velocity in m/s, force in N; no sheet yet.
ForceSurface makeEmptySurface(const std::string& title);

/// Medians of f over cells of (q, v), as many cells as the samples fill. All sheets of a surface must have the same q
/// and v.
/// @param points a point for each cell in place of a sheet
void addSheet(ForceSurface& surface, const std::string& name, const ComponentData& data, bool points, int color);

}  // namespace wems::identify::commands
