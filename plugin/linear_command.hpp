/// @file
/// `simulate --modes`, `--frf`: what the linear model says, without a run.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "plugin/simulate_options.hpp"

namespace wems::plugin {

/// Reads model and spectrum, prints and writes what was asked for. @throws InputError
void runLinearAnalysis(const SimulateOptions& options);

/// `5:50` as two frequencies, ascending. @throws InputError naming `option`
std::pair<double, double> parseBand(const std::string& text, const std::string& option);

/// Writes to a file, or to standard output for `-`; nothing for an empty name. @return whether it went to standard
/// output
bool writeJsonText(const nlohmann::json& result, const std::string& file);

}  // namespace wems::plugin
