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

/// `[{"name", "value", "unit", "interval95", "interval95_with_gains"}]`; an infinite bound is null.
nlohmann::json formatParameters(const std::vector<ComponentParameter>& parameters, const GainTolerances& gains);

/// Adds a row for each: name, value, bounds, unit.
Table tabulateParameters(const std::vector<ComponentParameter>& parameters);

/// `with gains within 1 %: 1.z.stiffness 14777 to 15201 N/m; …`
std::string describeGains(const std::vector<ComponentParameter>& parameters, const GainTolerances& gains);

nlohmann::json toJson(const ComponentFit& fit);
/// Table, what is not identifiable, residual, notes.
std::string formatText(const ComponentFit& fit, TextStyle style);

// What the search for a law with memory found (identify/component/component_diagnosis.hpp), as table and JSON.

/// Parameters of the law that was chosen, every law that was tried, and the errors of the chosen one on other tests.
nlohmann::json toJson(const LawSelection& selection, const std::vector<ComponentData>& others,
                      const GainTolerances& gains);
std::string formatText(const LawSelection& selection, const std::vector<ComponentData>& others, TextStyle style);

}  // namespace wems::identify::commands
