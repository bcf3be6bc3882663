/// @file
/// The device in motion, as a report shows it: poses of both rigid parts, forces and closed stops at stations along a
/// run. At each station a short stretch of samples (some periods of the drive) is kept whole, so that the motion can be
/// played slowly there without aliasing, and the file stays small however long the run is.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "models/device_drawing.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

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

/// Where a sensor sits.
struct SceneSensor {
    std::string name;  ///< `mobile.4`
    Part part = Part::mobile;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m, in the part's frame
};

struct MotionScene {
    std::string title;
    MountModel model;                 ///< connections, clearances and centre of gravity are drawn
    std::vector<DrawnShape> drawing;  ///< empty: a stand-in
    std::vector<SceneSensor> sensors;
    std::vector<SceneRun> runs;
};

/// Places `wanted` stations at equal times along samples of a run; neighbours may overlap in a short run. A station
/// holds two periods of the drive, 0.2 s where it is no sine, in some 48 frames.
/// @param time s @param hertz swept frequency, NaN where there is none: of a sample by its number
/// @param[out] samples numbers of the samples that are the frames, station by station
std::vector<MotionStation> placeStations(Eigen::Index count, double interval, Eigen::Index wanted,
                                         const std::function<double(Eigen::Index)>& time,
                                         const std::function<double(Eigen::Index)>& hertz,
                                         std::vector<Eigen::Index>& samples);

/// 1 for each stop, in the order of the model, that is closed at relative displacements q (rows 3 i + axis, m).
Eigen::VectorXi findClosedStops(const MountModel& model, const Eigen::Ref<const Eigen::VectorXd>& q);

/// Sensors of the channels of a recording: at the model's connections and at its places.
std::vector<SceneSensor> listSceneSensors(const Recording& recording, const MountModel& model);

/// The scene as a JavaScript object; values have four digits of their largest.
std::string formatScene(const MotionScene& scene);

}  // namespace wems
