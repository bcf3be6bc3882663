/// @file
/// Levels of one channel.
#pragma once

#include <string>
#include <vector>

#include "models/recording/recording.hpp"

namespace wems::identify {

struct ChannelStatistics {
    std::string name, unit;  ///< SI unit
    double rms = 0;          ///< about the mean
    double mean = 0, lowest = 0, highest = 0;
    double noise = 0;                   ///< RMS of white noise, from sixth differences
    double signal_to_noise = 0;         ///< dB; infinite without noise
    double band_from = 0, band_to = 0;  ///< Hz: where 99 % of its power is
};

ChannelStatistics calcStatistics(const Channel& channel, double interval);

}  // namespace wems::identify
