/// @file
/// A component fit as text and data: the same table and the same JSON as the fit of a whole mount.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "identify/commands/format.hpp"
#include "identify/component/component_diagnosis.hpp"
#include "identify/component/component_fit.hpp"
#include "models/common/text_table.hpp"

namespace wems::identify::commands {

/// `[{"name", "value", "unit", "interval95"}]`; an infinite bound is null.
nlohmann::json formatParameters(const std::vector<ComponentParameter>& parameters);

/// Adds a row for each: name, value, bounds, unit.
Table tabulateParameters(const std::vector<ComponentParameter>& parameters);

nlohmann::json toJson(const ComponentFit& fit);
/// Table, what is not identifiable, residual, notes.
std::string formatText(const ComponentFit& fit, TextStyle style);

// What the search for a law with memory found (identify/component/component_diagnosis.hpp), as table and JSON.

/// Parameters of the law that was chosen, every law that was tried, and the errors of the chosen one on other tests.
nlohmann::json toJson(const LawSelection& selection, const std::vector<ComponentData>& others);
std::string formatText(const LawSelection& selection, const std::vector<ComponentData>& others, TextStyle style);

}  // namespace wems::identify::commands
