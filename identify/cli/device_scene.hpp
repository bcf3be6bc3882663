/// @file
/// Runs as a report shows them moving: stations along the run, the model's forces along the measured motion.
#pragma once

#include <string>
#include <vector>

#include "identify/motion/motion.hpp"
#include "models/recording/recording.hpp"
#include "models/report/html_report.hpp"
#include "models/report/motion_scene.hpp"

namespace wems::identify::cli {

/// @param runs motion of each of `recordings`, which tell the swept frequency
/// @param model whose laws give the forces and whose clearances tell when a stop is closed
/// @param drawing what is drawn of the parts; empty: a stand-in
MotionScene makeDeviceScene(const std::vector<RunMotion>& runs, const std::vector<Recording>& recordings,
                            const MountModel& model, const std::vector<DrawnShape>& drawing);

/// The same where the motion is not at hand yet. @throws InputError if it cannot be recovered from a recording.
MotionScene makeDeviceScene(const std::vector<Recording>& recordings, const MountModel& model,
                            const std::vector<DrawnShape>& drawing);

/// The scene with a heading and what it shows in words.
void addMotion(HtmlReport& page, const MotionScene& scene);

}  // namespace wems::identify::cli
