/// @file
/// The device in motion at places along a run, for its report.
#pragma once

#include <utility>
#include <vector>

#include "models/report/motion_scene.hpp"
#include "plugin/device.hpp"
#include "plugin/sample_times.hpp"

namespace wems::plugin {

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

}  // namespace wems::plugin
