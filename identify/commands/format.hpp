/// @file
/// Numbers as the commands show them and write them as data.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "models/common/text_table.hpp"

namespace wems::identify::commands {

using wems::Table;

/// `digits` significant digits, no trailing noise, powers of ten only from 1e7 on and below 1e-4; `-` for a value that
/// is not finite.
std::string formatNumber(double value, int digits = 5);
/// Of a share: `1.23 %`
std::string formatPercent(double share);
/// JSON has no infinity and no NaN: null.
nlohmann::json numberOrNull(double value);

}  // namespace wems::identify::commands
