/// @file
/// What the search for a law with memory found (identify/component/law_selection.hpp), as table and JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "identify/component/law_selection.hpp"

namespace wems::identify::cli {

/// Parameters of the law that was chosen, every law that was tried, and the errors of the chosen one on other tests.
nlohmann::json formatSelection(const LawSelection& selection, const std::vector<ComponentData>& others);
void printSelection(const LawSelection& selection, const std::vector<ComponentData>& others);

}  // namespace wems::identify::cli
