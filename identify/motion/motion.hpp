/// @file
/// From a recording to the motion of both rigid parts: the step between channels and equations of motion.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identify/motion/channel_suspects.hpp"
#include "identify/motion/fusion.hpp"
#include "identify/motion/noise_density.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

/// Motion of one rigid part over all samples; column k belongs to time[k]. Frames: G coincides with F at rest (without
/// gravity). The static equilibrium of the model is included: at rest p and theta are those of the equilibrium, not
/// zero.
struct PartMotion {
    Eigen::Matrix3Xd p;      ///< origin of the part's frame (Mo or Fo) in G, m
    Eigen::Matrix3Xd theta;  ///< rotation vector, R = exp([theta]×), rad
    Eigen::Matrix3Xd v;      ///< velocity of the origin in G, m/s
    Eigen::Matrix3Xd w;      ///< angular velocity in G, rad/s
    Eigen::Matrix3Xd a;      ///< acceleration of the origin in G, m/s²
    Eigen::Matrix3Xd alpha;  ///< angular acceleration in G, rad/s²

    bool displacement_measured = false;  ///< p and theta rest on displacement channels
    bool acceleration_measured = false;  ///< a and alpha rest on acceleration channels
    double displacement_noise = 0;  ///< m RMS of one channel, from what the rigid fit leaves; NaN if it cannot be told
    double acceleration_noise = 0;  ///< m/s² RMS of one channel, likewise
    /// The same by frequency; zero where it cannot be told.
    NoiseDensity displacement_density{0.0}, acceleration_density{0.0};
    /// Where both kinds of channel were fused (fusion.hpp): the weights of each coordinate, origin above rotation, at
    /// each sample. Empty otherwise.
    Eigen::Matrix<float, 6, Eigen::Dynamic> fusion_weights;
    Calibration displacement_calibration, acceleration_calibration;  ///< empty without such channels
    /// Covariances of (origin, rotation), or their accelerations, from unit noise on every channel; zero where there
    /// are no such channels.
    Eigen::Matrix<double, 6, 6> displacement_covariance = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 6> acceleration_covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

/// What the motion of the fixed part rests on.
enum class FixedSource {
    channels,  ///< its own
    base,      ///< it follows the recorded base
    still      ///< neither: it stands still
};

/// Motion of both parts in one run.
struct RunMotion {
    std::string file;
    std::vector<double> time;  ///< s, uniform (resampled where the recording's was not, which `notes` says)
    double interval = 0;       ///< s
    PartMotion mobile, fixed;
    FixedSource fixed_source = FixedSource::channels;
    Eigen::Matrix3Xd load;               ///< N in G, where the model has it act; empty if not recorded
    Eigen::Matrix3Xd base;               ///< m/s²; empty if not recorded
    Eigen::Matrix3Xd base_displacement;  ///< m, from `base`, above 0.6 of the lowest excited frequency; empty without
    double trusted_from = 0;  ///< Hz: below this, displacements derived from accelerations say nothing, of either part
    double mobile_trusted_from = 0, fixed_trusted_from = 0;  ///< Hz, of each part; 0 where displacements were measured
    double sufficient_rate = 0;      ///< Hz, of sampling, for derivatives of displacements that hold; 0 if they do
    double trusted_to = 0;           ///< Hz: above this, derived accelerations or velocities are not to be trusted
    std::vector<std::string> notes;  ///< how each missing quantity was derived and in which band it is trusted
};

/// Rigid motion of both parts from whatever displacement, velocity and acceleration channels there are.
/// - Displacements: best rigid fit (Kabsch) of the connections' positions, each sample on its own.
/// - Accelerations: least squares of a_i = a + α × r + ω × (ω × r) in (a, α).
/// - Both: displacement and acceleration fused by the penalised least squares that weighs each by its noise; no bias in
/// any band.
/// - One alone: the other derived, zero-phase; the notes say how.
/// Of a guided mobile part (`[body] motion`) only the free motions are determined, relative to the fixed part; the held
/// ones are those of the fixed part. Of the fixed part then the free directions suffice: what its channels do not tell
/// is taken as zero. All motion is absolute, as the channels are.
/// A model without bracket whose recording has no `fixed` channels, or too few, follows the recorded base; without base
/// it stands still.
/// @param edges of displacements and accelerations that are fused
/// @throws InputError if the motions cannot be recovered, naming which.
RunMotion estimateMotion(const Recording& recording, const MountModel& model,
                         ContactEdges edges = ContactEdges::sampled);

}  // namespace wems::identify
