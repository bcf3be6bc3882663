/// @file
/// What the search for a law with memory found (identify/component/law_selection.hpp), as table and JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "identify/component/law_selection.hpp"
#include "models/terminal.hpp"

namespace wems::identify::commands {

/// Parameters of the law that was chosen, every law that was tried, and the errors of the chosen one on other tests.
nlohmann::json toJson(const LawSelection& selection, const std::vector<ComponentData>& others);
std::string formatText(const LawSelection& selection, const std::vector<ComponentData>& others, TextStyle style);

}  // namespace wems::identify::commands
