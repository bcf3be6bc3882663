/// @file
/// Printing a component fit: the same table and the same JSON as the fit of a whole mount.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "identify/cli/command.hpp"
#include "identify/component/component_fit.hpp"

namespace wems::identify::cli {

/// `[{"name", "value", "unit", "interval95"}]`; an infinite bound is null.
nlohmann::json formatParameters(const std::vector<ComponentParameter>& parameters);

/// Adds a row for each: name, value, bounds, unit.
Table tabulateParameters(const std::vector<ComponentParameter>& parameters);

/// Table on standard output (unless JSON goes there) and JSON if it was asked for.
void reportComponentFit(const ComponentFit& fit, const CommonOptions& options, OutputFiles& outputs);

}  // namespace wems::identify::cli
