/// @file
/// `simulate --modes`, `--frf`: what the linear model says, without a run.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "models/atomic_file.hpp"
#include "models/mount_model.hpp"
#include "plugin/linear_analysis.hpp"
#include "plugin/simulate_options.hpp"

namespace wems::plugin {

/// What the options ask of the linear model; reads a spectrum. @throws InputError
LinearQuestion makeQuestion(const SimulateOptions& options);

/// Reads model and spectrum, prints and writes what was asked for. @throws InputError
void runLinearAnalysis(const SimulateOptions& options);

/// `5:50` as two frequencies, ascending. @throws InputError naming `option`
std::pair<double, double> parseBand(const std::string& text, const std::string& option);

/// The files of a command without a run, checked against the model's before anything is computed.
/// @throws InputError if one of them is read
OutputFiles beginOutputs(const SimulateOptions& options, const MountModel& model);

/// Writes JSON, or `text` to standard output unless --quiet or --json - took it; then all files appear, or none.
void finishOutputs(const SimulateOptions& options, const nlohmann::json& result, const std::string& text,
                   OutputFiles& outputs);

}  // namespace wems::plugin
