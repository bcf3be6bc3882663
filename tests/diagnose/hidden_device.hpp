/// @file
/// A device drawn at random and recordings of it: what the diagnosis is tested with.
#pragma once

#include <random>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify::testing {

/// Three to six connections on a ring, stops on z and outward, a bracket of six modes.
MountModel makeRandomDevice(std::mt19937_64& random);

struct RunPlan {
    double duration = 16;                             ///< s, logarithmic sweep 5–50 Hz
    Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< N
    bool upward = true;
    double noise = 2e-6;  ///< m, each displacement channel
    double rate = 1000;   ///< Hz
};

/// Displacements of both ends of all connections and the load, as a laboratory would record `truth`.
Recording recordRun(const MountModel& truth, const RunPlan& plan, std::mt19937_64& random);

}  // namespace wems::identify::testing
