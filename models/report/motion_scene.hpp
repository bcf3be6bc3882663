/// @file
/// The device in motion, as a report shows it: poses of both rigid parts, forces and closed stops at stations along a
/// run. At each station a short stretch of samples (some periods of the drive) is kept whole, so that the motion can be
/// played slowly there without aliasing, and the file stays small however long the run is.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "models/mount_model.hpp"

namespace wems {

/// Consecutive frames of a run that are played in a loop.
struct MotionStation {
    double hertz = 0;       ///< swept frequency; NaN if the drive is no sine
    double time = 0;        ///< s, of the first frame
    double period = 0;      ///< s between two frames
    Eigen::Index from = 0;  ///< first frame
    Eigen::Index count = 0;
};

/// Frames of one run, one column each.
struct SceneRun {
    std::string name;
    std::vector<MotionStation> stations;
    Eigen::MatrixXd mobile;  ///< 6 rows: origin (m) and rotation vector (rad) of the mobile frame in G
    Eigen::MatrixXd fixed;   ///< likewise of the fixed frame
    Eigen::MatrixXd force;   ///< N on the mobile part, F axes: rows 3 i + axis of connection i
    Eigen::MatrixXi closed;  ///< 1 where a stop is closed: one row for each stop, in the order of the model
};

struct MotionScene {
    std::string title;
    MountModel model;  ///< connections, clearances and centre of gravity are drawn
    std::vector<SceneRun> runs;
};

/// The scene as a JavaScript object; values have four digits of their largest.
std::string formatScene(const MotionScene& scene);

}  // namespace wems
