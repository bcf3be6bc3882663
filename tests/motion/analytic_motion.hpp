/// @file
/// A rigid motion in closed form and the recording that perfect or noisy sensors would make of it.
#pragma once

#include <Eigen/Core>
#include <random>
#include <string>
#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::test {

/// Translation and Bryant angles are sums of two sines each. Velocities are analytic; ω by the rate map, α by a
/// fourth-order difference of ω: no formula of the code under test.
class AnalyticMotion {
public:
    AnalyticMotion(std::mt19937& random, double amplitude, double angle, double lowest, double highest);

    Eigen::Vector3d p(double t) const;
    Eigen::Vector3d v(double t) const;
    Eigen::Vector3d a(double t) const;
    Eigen::Matrix3d R(double t) const;
    Eigen::Vector3d w(double t) const;
    Eigen::Vector3d alpha(double t) const;
    double lowestFrequency() const { return frequency_.minCoeff(); }
    double highestFrequency() const { return frequency_.maxCoeff(); }

private:
    double sum(int coordinate, double t, int derivative) const;
    Eigen::Vector3d angles(double t, int derivative) const;

    Eigen::Matrix<double, 6, 2> amplitude_, frequency_, phase_;
};

struct SensorNoise {
    double displacement = 0, acceleration = 0;
};

/// A mount on the four ends of a cross with half arm 0.1 m, no bracket; 1e5 N/m everywhere.
MountModel makeCrossModel();

/// Adds channels of `part` for all connections of the model. `quantities` are channel suffixes (`x`, `az` …).
void addChannels(Recording& recording, const MountModel& model, const std::string& part, const AnalyticMotion& motion,
                 const std::vector<std::string>& quantities, SensorNoise noise, std::mt19937& random);

/// Uniform stamps.
Recording makeEmptyRecording(double sample_rate, double duration);

}  // namespace wems::test
