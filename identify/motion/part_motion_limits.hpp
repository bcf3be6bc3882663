/// @file
/// Choices that hold for a part with six motions and for a guided one alike.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdio>
#include <string>

namespace wems::identify {

/// Passes over the centripetal terms; each gains two to four digits.
constexpr int kMostPasses = 10;
/// What a pass may still change of the centripetal acceleration, relative to the largest angular acceleration.
constexpr double kPassTolerance = 1e-6;
/// Displacements from accelerations count from this part of the lowest excited frequency on.
constexpr double kIntegrationMargin = 0.6;
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

}  // namespace wems::identify
