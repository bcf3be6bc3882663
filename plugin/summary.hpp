/// @file
/// What the executable simulate says about a run: text, JSON, HTML.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "models/mount_model.hpp"
#include "models/terminal.hpp"
#include "plugin/connection_overview.hpp"
#include "plugin/drive.hpp"
#include "plugin/run_overview.hpp"
#include "plugin/scene_recorder.hpp"
#include "plugin/simulation.hpp"

namespace wems::plugin {

/// The run that a summary is about; refers to what the caller keeps.
struct RunDescription {
    const MountModel& model;
    const Drive& drive;
    const SimulationResult& result;
    double time_offset;  ///< s, added to all times of the result
};

/// Stops that were reached (from and to which frequency and time, deepest penetration), the largest relative
/// displacements, and what the run cost.
std::string formatSummary(const RunDescription& run, TextStyle style);
nlohmann::json makeSummaryJson(const RunDescription& run);

/// The summary with what each connection went through, the device in motion, and plots of displacements and
/// accelerations; channels that stood still are left out.
/// @param overview of the recording, whose metadata it shows, times as in the recording
/// @throws InputError: cannot be written.
void writeHtmlSummary(const RunDescription& run, const Recording& header, const RunOverview& overview,
                      const ConnectionOverview& connections, const SceneRecorder& scene, const std::string& file,
                      OutputFiles& outputs);

}  // namespace wems::plugin
