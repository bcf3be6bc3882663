/// @file
/// A component fit as text and data: the same table and the same JSON as the fit of a whole mount.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "identify/commands/format.hpp"
#include "identify/component/component_fit.hpp"

namespace wems::identify::commands {

/// `[{"name", "value", "unit", "interval95"}]`; an infinite bound is null.
nlohmann::json formatParameters(const std::vector<ComponentParameter>& parameters);

/// Adds a row for each: name, value, bounds, unit.
Table tabulateParameters(const std::vector<ComponentParameter>& parameters);

nlohmann::json toJson(const ComponentFit& fit);
/// Table, what is not identifiable, residual, notes.
std::string formatText(const ComponentFit& fit, TextStyle style);

}  // namespace wems::identify::commands
