/// @file
/// What the executable simulate says about a run: text, JSON, HTML.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "models/common/text_table.hpp"
#include "models/mount_model.hpp"
#include "models/report/motion_scene.hpp"
#include "plugin/device.hpp"
#include "plugin/drive.hpp"
#include "plugin/recorder.hpp"
#include "plugin/run_overview.hpp"
#include "plugin/simulation.hpp"

namespace wems::plugin {

// The device in motion at places along a run, for its report.

/// Keeps the frames of some stations, in memory that does not grow with the run.
class SceneRecorder {
public:
    /// @param model, drive must outlive the object @param times of the samples
    /// @param drawing of the device; empty: a stand-in
    SceneRecorder(const MountModel& model, const Drive& drive, const SampleTimes& times,
                  std::vector<DrawnShape> drawing);
    /// Every sample of the run, one after the other.
    void add(const DeviceMotion& motion);
    /// @param time_offset s, added to all times @param recording whose channels tell where sensors are
    MotionScene finish(double time_offset, const Recording& recording) const;

private:
    const MountModel& model_;
    std::vector<DrawnShape> drawing_;
    SceneRun run_;
    std::vector<std::pair<Eigen::Index, Eigen::Index>> wanted_;  // sample, frame; ascending
    std::size_t next_ = 0;                                       // of wanted_
    Eigen::Index sample_ = 0;
};

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
