/// @file
/// The recorded load where it acts: at the bracket's load point, or at a point of either part ([load] in the model).
#pragma once

#include <Eigen/Core>

#include "identify/problem/open_loop_run.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

/// The load with the model's gains, N, in G: 3 x samples. Empty if the recording has none.
Eigen::MatrixXd calcLoad(const OpenLoopRun& run, const MountModel& model);

/// True if the recorded load acts on the mobile part itself.
bool loadsMobilePart(const OpenLoopRun& run, const MountModel& model);

/// What a load (3 x samples) at a point is about its part's origin: force above moment, in G, 6 x samples.
Eigen::MatrixXd calcLoadWrench(const OpenLoopRun& run, const LoadPoint& point,
                               const Eigen::Ref<const Eigen::MatrixXd>& load);

/// The same of unit loads along the axes, at rest.
Eigen::Matrix<double, 6, 3> calcLoadArm(const LoadPoint& point);

}  // namespace wems::identify
