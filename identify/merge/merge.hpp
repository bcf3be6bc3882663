/// @file
/// Several recordings of one run as one: common time, common rate.
#pragma once

#include <string>
#include <vector>

#include "identify/merge/resampling.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

struct MergeOptions {
    std::string common;  ///< channel of all recordings that aligns them; empty: their time stamps are taken as they are
    double rate = 0;     ///< Hz; 0: the lowest of all
};

/// The common channel as one recording has it, on the first one's clock.
struct AlignedChannel {
    std::string file;
    UniformSignal signal;
};

struct MergedRecording {
    Recording recording;
    std::vector<AlignedChannel> common;  ///< of each recording; none without common channel
};

/// Channels of all recordings over the time that they share, on the first one's clock, resampled without aliasing
/// (resampling.hpp). Of the common channel the first one's is kept. What was shifted by how much stands in `warnings`.
/// @throws InputError: fewer than two recordings, a channel twice, no common channel, no overlap, the common channels
///         do not match (correlation below 0.5)
MergedRecording merge(const std::vector<Recording>& recordings, const MergeOptions& options);

}  // namespace wems::identify
