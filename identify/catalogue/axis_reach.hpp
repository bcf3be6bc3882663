/// @file
/// How far and how fast the axes of the connections moved: the scale of what may be sought there.
#pragma once

#include <Eigen/Core>

#include "identify/motion/motion.hpp"
#include "models/mount_model.hpp"

namespace wems::identify::updating {

/// Largest relative displacement of each axis of each connection in any run, m: row 3 i + axis, to either side; and
/// the largest relative velocity of all, m/s.
struct AxisReach {
    Eigen::VectorXd positive, negative;
    double velocity = 0;

    explicit AxisReach(const MountModel& model);
    void widen(const RunMotion& motion, const MountModel& model);
};

}  // namespace wems::identify::updating
