/// @file
/// Motion of one part from its channels: chooses between fusion, differentiation and integration.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "identify/motion/motion.hpp"
#include "models/mount_forces.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

// Choices that hold for a part with six motions and for a guided one alike.

/// Passes over the centripetal terms; each gains two to four digits.
constexpr int kMostPasses = 10;
/// What a pass may still change of the centripetal acceleration, relative to the largest angular acceleration.
constexpr double kPassTolerance = 1e-6;
/// Displacements from accelerations count from this part of the lowest excited frequency on.
constexpr double kIntegrationMargin = 0.6;
/// They are compared from this times that on. Below, nothing drives and integrated noise is largest: of 27 drawn runs a
/// true model left 0.19 to 0.99 of what it leaves from 1 on. A high pass that ends here begins where that of the
/// integration ends; where they overlapped, 0.4 to 1 % were left in runs whose contacts shift the mean.
constexpr double kComparedMargin = 1.5;
/// Differentiated displacements keep at least this many times the highest excited frequency: the gain there is 0.9986.
constexpr double kSweepMargin = 3;
/// No measurement is better than this part of its own RMS: keeps weights finite for noise-free data.
constexpr double kNoiseFloor = 1e-9;
/// Of channels that are zero throughout (m, m/s²): a part that stands still is not weighed by 0/0.
constexpr double kLeastDisplacementNoise = 1e-15, kLeastAccelerationNoise = 1e-12;

inline std::string formatHertz(double f) {
    char text[40];
    std::snprintf(text, sizeof text, "%.3g Hz", f);
    return text;
}

inline double rms(const Eigen::Ref<const Eigen::MatrixXd>& values) {
    return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

struct PartEstimate {
    PartMotion motion;
    double trusted_from = 0;         ///< Hz
    double trusted_to = 0;           ///< Hz
    double sufficient_rate = 0;      ///< Hz, as in RunMotion
    std::vector<std::string> notes;  ///< begin with the part's name
};

/// @param recording uniformly sampled
/// @param part mobile or fixed, with at least one channel
/// @param rest pose at the static equilibrium, from which displacements count
/// @throws InputError if neither displacements nor accelerations determine all six motions, naming those left open.
PartEstimate estimatePart(const Recording& recording, const MountModel& model, Part part, const BodyMotion& rest,
                          ContactEdges edges = ContactEdges::sampled);

/// True if displacement, velocity or acceleration channels of this part determine all six motions.
bool determinesPart(const Recording& recording, const MountModel& model, Part part, const BodyMotion& rest);

/// A part that translates with a measured acceleration (base motion).
PartEstimate estimateTranslation(const Recording& recording, const Eigen::Matrix3Xd& acceleration,
                                 const BodyMotion& rest);

/// A part that stays at `rest`.
PartMotion makeStandstill(const BodyMotion& rest, Eigen::Index samples);

/// Pose of the fixed part at the static equilibrium.
BodyMotion findFixedRest(const MountModel& model, const StaticEquilibrium& equilibrium);

/// True if `recording` has displacement, velocity or acceleration channels of this part.
bool hasChannels(const Recording& recording, Part part);

}  // namespace wems::identify
