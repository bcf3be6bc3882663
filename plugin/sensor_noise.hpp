/// @file
/// Noise of the sensors on a simulated recording.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "models/recording/recording.hpp"

namespace wems::plugin {

/// RMS of independent Gaussian noise on each sample; zero = none.
struct SensorNoise {
    double displacement = 0;  ///< m
    double velocity = 0;      ///< m/s
    double acceleration = 0;  ///< m/s², of both ends of the connections
    double load = 0;          ///< N
    double base = 0;          ///< m/s², of the recorded base acceleration
};

/// RMS of the noise on a channel of this name.
double getNoiseLevel(const SensorNoise& noise, const ChannelName& name);

/// The noise of one channel, block after block. The sequence depends on the seed and the channel's name alone, so that
/// a channel's noise is the same whatever else is recorded.
class ChannelNoise {
public:
    ChannelNoise(const SensorNoise& noise, std::uint64_t seed, const ChannelName& name);
    /// Adds it to the next values.
    void add(std::vector<double>& values);

private:
    bool present_;
    std::mt19937_64 generator_;
    std::normal_distribution<double> normal_;
};

}  // namespace wems::plugin
