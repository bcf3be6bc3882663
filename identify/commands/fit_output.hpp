/// @file
/// A fit as data and as tables.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "identify/fit/fit.hpp"
#include "models/text_table.hpp"

namespace wems::identify::commands {

using Timing = std::vector<std::pair<std::string, double>>;  ///< step, s

nlohmann::json makeFitJson(const FitResult& fit, const std::vector<std::string>& notes, const Timing& timing);
Table makeParameterTable(const FitResult& fit);
/// What is not known one by one.
Table makeOpenTable(const FitResult& fit);
std::string describeResidual(const FitResult& fit);

}  // namespace wems::identify::commands
