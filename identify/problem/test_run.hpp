/// @file
/// One recording of a test, prepared: what does not depend on the state that it is judged at.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "identify/motion/motion.hpp"
#include "identify/motion/noise_density.hpp"
#include "identify/motion/swept_frequency.hpp"
#include "identify/problem/open_loop_run.hpp"
#include "identify/problem/sensor_layout.hpp"

namespace wems::identify {

struct TestRun {
    Recording recording;  ///< uniformly sampled
    SweptFrequency swept;
    ExcitedBand band;
    RunMotion motion;                 ///< with exact sensors
    std::vector<NoiseDensity> noise;  ///< of a channel of each group of the layout
    NoiseDensity load_noise{0.0};     ///< N², of each axis
};

/// @param believed positions of sensors and the static rest are those of this model
TestRun prepareTestRun(const Recording& recording, const SensorLayout& layout, const MountModel& believed);

/// Noise of a channel of each group, as the recording and the rigid motions of a run show it: where channels have
/// redundancy, what no rigid motion can make.
std::vector<NoiseDensity> estimateChannelNoise(const TestRun& run, const SensorLayout& layout);

/// Rows of a group that this recording has: indices into layout.channels and the samples (channels x samples).
struct GroupSamples {
    std::vector<int> channels;
    Eigen::MatrixXd values;
    bool empty() const { return channels.empty(); }
};
GroupSamples collectGroup(const Recording& recording, const SensorLayout& layout, int group);

/// (displacement of a channel) = row · (translation, rotation of its part), at rest: channels x 6.
Eigen::MatrixXd makeChannelDesign(const SensorLayout& layout, const std::vector<int>& channels);

/// What a channel would read of a rigid motion: displacement from rest or acceleration of its point.
/// @param rest translation and rotation vector of the part at rest
double calcChannelMotion(const SensorChannel& channel, Derivative derivative, const Eigen::Matrix3d& R,
                         const Eigen::Vector3d& p, const Eigen::Vector3d& w, const Eigen::Vector3d& a,
                         const Eigen::Vector3d& alpha);

}  // namespace wems::identify
