/// @file
/// The pictures of a restoring force surface.
#pragma once

#include <string>

#include "identify/component/component_data.hpp"
#include "identify/component/surface_kind.hpp"
#include "models/atomic_file.hpp"

namespace wems::identify::commands {

/// Writes a page with the kind, its parameters, force over displacement and velocity, both slices and the force over
/// the travel since the last reversal. @throws InputError if the file cannot be written.
void writeSurfaceReport(const ComponentData& data, const SurfaceKind& kind, const std::string& file,
                        OutputFiles& outputs);

}  // namespace wems::identify::commands
