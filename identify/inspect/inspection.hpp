/// @file
/// What is in a recording, what is suspicious about it, and what can be identified from it.
#pragma once

#include <string>
#include <vector>

#include "identify/inspect/channel_statistics.hpp"
#include "identify/inspect/order_tracking.hpp"
#include "identify/motion/swept_frequency.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

struct Inspection {
    double rate = 0;      ///< Hz, mean
    double duration = 0;  ///< s
    SweptFrequency swept;
    std::vector<ChannelStatistics> channels;
    OrderTracking orders;
    std::vector<Finding> findings;       ///< of reading and of the signals, in order of time
    std::vector<std::string> abilities;  ///< one sentence each
    std::vector<std::string> notes;
};

/// @param model may be null; with it, exchanged and missing connections and channels that are not rigid are findings
/// too
Inspection inspect(const Recording& recording, const MountModel* model);

/// Only the findings that need no model: what inspect() looks for in time stamps and signals.
std::vector<Finding> findDefects(const Recording& recording, const SweptFrequency& swept);

}  // namespace wems::identify
