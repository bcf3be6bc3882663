/// @file
/// A plan as table, data and page.
#pragma once

#include <string>

#include "identify/commands/format.hpp"
#include "identify/plan/plan.hpp"

namespace wems::identify::commands {

/// @param model_file that the command lines of the proposals name
std::string formatPlan(const Plan& plan, const std::string& model_file, TextStyle style);
nlohmann::json makePlanJson(const Plan& plan, const std::string& model_file);
/// @throws InputError if the file cannot be written
void writePlanReport(const Plan& plan, const std::string& model_file, const std::string& file, OutputFiles& outputs);

}  // namespace wems::identify::commands
