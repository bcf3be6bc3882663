/// @file
/// One thing that is odd about a recording.
#pragma once

#include <string>

namespace wems {

enum class FindingKind {
    repeated_time,
    backward_time,
    gap,
    non_uniform_time,
    missing_value,
    empty_channel,
    clipped,
    saturated,
    drop_out,
    hum,
    offset,
    drift,
    constant,
    missing_connection,
    unknown_connection,
    swapped
};

/// `repeated_time`, `gap` … as result files name the kind.
const char* kindName(FindingKind kind);

struct Finding {
    FindingKind kind = FindingKind::gap;
    std::string channel;  ///< `time`, a channel, or `mobile.1` for all channels of a connection
    long row = 0;         ///< of the file, the first one concerned; 0 if the whole recording is
    double time = 0;      ///< s, of that row
    std::string message;  ///< one sentence
};

}  // namespace wems
