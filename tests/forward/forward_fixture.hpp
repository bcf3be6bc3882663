/// @file
/// Models and drives that the tests of the forward model share.
#pragma once

#include <Eigen/Core>

#include "identify/forward/forward_model.hpp"
#include "models/mount_model.hpp"

namespace wems::test {

/// Four connections on a cross with unequal laws, an offset centre of gravity, a full inertia and no bracket.
MountModel makeCross();
/// Three modes with coupled translations and rotations.
std::vector<BracketMode> makeBracketModes();
/// 2 kg on one connection through its centre of gravity: 2e4 N/m along z, nothing along x and y.
MountModel makeOscillator();
/// A body without any force on it.
MountModel makeFreeBody();

identify::TimeGrid makeGrid(double interval, int samples, int steps_per_sample = 1);

/// A load of three sines with a soft start, at the times of the grid.
Eigen::Matrix3Xd makeLoad(const identify::TimeGrid& grid, double amplitude);
std::vector<double> makeTimes(const identify::TimeGrid& grid);

/// Root mean square of a − b over that of b.
double calcRelativeError(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

}  // namespace wems::test
