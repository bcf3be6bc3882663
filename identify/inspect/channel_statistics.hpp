/// @file
/// Levels of one channel.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identify/motion/spectrum.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

struct ChannelStatistics {
    std::string name, unit;  ///< SI unit
    double rms = 0;          ///< about the mean
    double mean = 0, lowest = 0, highest = 0;
    double noise = 0;                   ///< RMS of white noise, from sixth differences
    double signal_to_noise = 0;         ///< dB; infinite without noise
    double band_from = 0, band_to = 0;  ///< Hz: where 99 % of its power is
    Spectrum spectrum;                  ///< empty where the sample interval is not known
};

/// Levels of a channel that comes in blocks, in memory that does not depend on their number.
class ChannelLevels {
public:
    /// @param channel of at least one sample; after the first block its first sample is the last of the block before
    /// @param interval s; 0 where it is not known
    void add(const Channel& channel, double interval);
    /// The noise is the root mean square of the blocks' own.
    ChannelStatistics finish() const;

private:
    void addMoments(const Eigen::Ref<const Eigen::VectorXd>& signal);

    std::string name_;
    double count_ = 0, mean_ = 0, squares_ = 0;  // squares about the mean
    double lowest_ = 0, highest_ = 0;
    double noise_power_ = 0, noise_samples_ = 0;  // sum over samples
    Spectrum spectrum_;                           // density: sum over samples
    double spectrum_samples_ = 0;
};

}  // namespace wems::identify
