/// @file
/// The verdict on a recording as data.
#pragma once

#include <nlohmann/json.hpp>

#include "identify/inspect/quality.hpp"

namespace wems::identify::commands {

/// `{"verdict", "reasons", "faults": [{"kind", "channel", …}], "checked", "contradiction"}`
nlohmann::json makeQualityJson(const QualityVerdict& verdict);

}  // namespace wems::identify::commands
