/// @file
/// The verdict on a recording as data.
#pragma once

#include <nlohmann/json.hpp>

#include "identify/inspect/quality.hpp"

namespace wems::identify::cli {

/// `{"verdict", "reasons", "faults": [{"kind", "channel", …}], "checked", "contradiction"}`
nlohmann::json makeQualityJson(const QualityVerdict& verdict);

}  // namespace wems::identify::cli
