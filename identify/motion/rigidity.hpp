/// @file
/// Does each part of a recording move as a rigid body? Checks of the measurement before any force law.
///
/// For displacements, errors in percent over time:
/// - `length i-j`: distance of two ends, relative to the distance at rest, for all pairs;
/// - for four ends that form a cross (two perpendicular arms with a common midpoint) also `perpendicularity` of the
/// arms,
///   relative to 90°, and `midpoint x|y|z`, the offset between the arms' midpoints relative to the mean arm length.
///   With the two arms' lengths these are the six invariants of four ends.
/// For accelerations without displacements: `acceleration field i`, what the best rigid field a + α × r + ω × (ω × r)
/// leaves at connection i, relative to the largest acceleration of any channel of the part.
/// The largest value contains the noise; `noise_percent` is the RMS that noise alone gives.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identify/motion/channel_suspects.hpp"
#include "identify/motion/swept_frequency.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

struct RigidityCheck {
    std::string name;  ///< of the fixed part with `fixed ` in front
    Eigen::VectorXd percent;
    double max_percent = 0;
    double at_time = 0;        ///< s
    double at_frequency = 0;   ///< Hz, swept frequency at that time; NaN if the drive is no sine
    double noise_percent = 0;  ///< NaN if the noise is not known
};

struct Rigidity {
    std::vector<double> time;  ///< s, of `percent`
    SweptFrequency swept;
    std::vector<RigidityCheck> checks;
    std::vector<ChannelSuspect> suspects;
    std::vector<std::string> notes;
};

/// @throws InputError if there is no part whose channels can be checked.
Rigidity checkRigidity(const Recording& recording, const MountModel& model);

}  // namespace wems::identify
