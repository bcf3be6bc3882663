/// @file
/// `simulate --response`: response curves by continuation.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "models/atomic_file.hpp"
#include "models/periodic/response_curve.hpp"
#include "models/terminal.hpp"
#include "plugin/simulate_options.hpp"

namespace wems::plugin {

struct LevelResponse {
    std::string level;  ///< `force z=200 N`
    ResponseCurve curve;
};

/// Computes, prints and writes what was asked for. @throws InputError
void runResponseCurves(const SimulateOptions& options);

/// `fold or pitchfork`, `period doubling`, `Neimark-Sacker`, or empty
const char* nameInstability(Instability instability);

std::string formatResponses(const MountModel& model, const std::vector<LevelResponse>& levels, TextStyle style);
nlohmann::json makeResponseJson(const MountModel& model, const std::vector<LevelResponse>& levels);
/// A row for each point of each curve.
std::string formatResponseCsv(const MountModel& model, const std::vector<LevelResponse>& levels);
/// All levels over each other, unstable parts and contact marked. @throws InputError: cannot be written.
void writeResponseReport(const MountModel& model, const std::vector<LevelResponse>& levels, const std::string& file,
                         OutputFiles& outputs);

/// Names of all stops in the order of a point's penetrations, and of all connections and axes in that of its
/// amplitudes.
std::vector<std::string> nameStops(const MountModel& model);
std::vector<std::string> nameAxes(const MountModel& model);

}  // namespace wems::plugin
