/// @file
/// `simulate --response`: response curves by continuation.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "models/common/atomic_file.hpp"
#include "models/common/text_table.hpp"
#include "models/periodic/response_curve.hpp"
#include "plugin/simulate_options.hpp"

namespace wems::plugin {

struct LevelResponse {
    std::string level;  ///< `force z=200 N`
    ResponseCurve curve;
};

/// Told now and then: share of the whole done, level, frequency (Hz), points of the level's curve so far.
using ResponseProgress = std::function<void(double done, const std::string& level, double frequency, int points)>;

/// The curve of each level. @throws InputError
std::vector<LevelResponse> calcResponses(const MountModel& model, const SimulateOptions& options,
                                         const ResponseProgress& progress);

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
