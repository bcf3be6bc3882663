/// @file
/// Signals of the one-axis equation: relative displacements, and the acceleration of one point of the mobile part.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

struct SingleAxisData {
    Eigen::MatrixXd q;         ///< samples × 3 · connections, relative displacements from rest, m
    Eigen::MatrixXd v;         ///< the same differentiated, m/s
    Eigen::MatrixXd a_centre;  ///< samples × 3, mean of the markers of the mobile part, m/s²
    Eigen::MatrixXd a_body;    ///< samples × 3, centre of gravity, m/s²
    Eigen::VectorXd hertz;     ///< swept frequency; NaN unless the drive is a sine
    std::vector<std::string> notes;
};

/// Plain differences and means of the recorded channels, as the classical method has them. What was not recorded
/// (displacements or accelerations), and the centre of gravity's acceleration, come from the rigid motion.
/// @throws InputError as estimateMotion()
SingleAxisData collectSingleAxisData(const Recording& recording, const MountModel& model);

}  // namespace wems::identify
