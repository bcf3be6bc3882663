/// @file
/// Runs with a known truth for the tests of the fit: the rigid body on its mount and bracket integrated by a classical
/// Runge–Kutta scheme written for these tests alone, and recordings of it with seeded sensor noise.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::test {

/// Exact motion at each sample, all in G.
struct SyntheticRun {
    MountModel model;
    double interval = 0;
    std::vector<double> time;
    std::vector<Eigen::Matrix3d> R_GM, R_GF;
    Eigen::Matrix3Xd p_M, v_M, w_M, a_M, alpha_M;
    Eigen::Matrix3Xd p_F, v_F, w_F, a_F, alpha_F;
    Eigen::Matrix3Xd load;

    /// Displacement from rest and acceleration at sample k, in G, of the material point of the mobile or the fixed part
    /// at `position` in the part's own frame.
    Eigen::Vector3d calcDisplacement(bool of_mobile, Eigen::Index k, const Eigen::Vector3d& position) const;
    Eigen::Vector3d calcAcceleration(bool of_mobile, Eigen::Index k, const Eigen::Vector3d& position) const;
};

struct SweepSettings {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< N, amplitude at the load point
    double from = 5, to = 50;                         ///< Hz
    double octaves_per_minute = 4;
    double sample_rate = 2000;  ///< Hz
    int steps_per_sample = 4;
};
SyntheticRun simulateSweep(const MountModel& model, const SweepSettings& settings);

struct SensorNoise {
    double displacement = 0;  ///< m RMS; negative: no displacement channels
    double acceleration = 0;  ///< m/s² RMS; negative: no acceleration channels
};
/// Channels of all connections of both parts, white Gaussian noise added.
Recording record(const SyntheticRun& run, const SensorNoise& noise, std::uint64_t seed);

/// The model with every stiffness, damping, clearance and stop stiffness off by a random factor within 1 ± `most`.
MountModel perturb(const MountModel& model, double most, std::uint64_t seed);

}  // namespace wems::test
