/// @file
/// A recording: channels sampled at common times, in SI units, named as the interface of the project names them.
///
/// Names: `mobile.<connection>.<q>`, `fixed.<connection>.<q>` with q one of x y z (displacement from rest, m), vx vy vz
/// (m/s), ax ay az (m/s², of that material point, ground axes); `load.fx|fy|fz` (N); `base.ax|ay|az` (m/s²);
/// `relative.<connection>.<q>` and `force.<connection>.<x|y|z>` (component test, f = +k q).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "models/common/units.hpp"

namespace wems {

// One thing that is odd about a recording.

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

enum class Part { mobile, fixed, relative, force, load, base };
enum class Derivative { displacement, velocity, acceleration, force };

/// The parts of a channel's name.
struct ChannelName {
    Part part = Part::mobile;
    std::string connection;  ///< empty for load and base
    int axis = 0;            ///< 0 x, 1 y, 2 z
    Derivative derivative = Derivative::displacement;
};
/// nullopt if `name` is none of the names above.
std::optional<ChannelName> parseChannelName(const std::string& name);
std::string formatChannelName(const ChannelName& name);
/// Quantity that the channel's unit must be of.
Quantity findQuantity(const ChannelName& name);

struct Channel {
    std::string name;            ///< as in the file (or the column map), without its unit
    std::string unit;            ///< unit of the file, `mm`; values are SI all the same
    std::vector<double> values;  ///< SI
    int column = 0;              ///< from 1, in the file
};

struct Recording {
    std::string file;
    std::string format;                           ///< `CSV`, `MATLAB 7.3` …; empty if it was never in a file
    std::map<std::string, std::string> metadata;  ///< the `# key: value` lines
    std::vector<double> time;                     ///< s, strictly increasing
    std::vector<Channel> channels;                ///< those whose name is known, in file order
    std::vector<std::string> unused_columns;      ///< other columns of the file
    std::vector<std::string> warnings;            ///< what was found odd and how it was treated, one sentence each
    std::vector<Finding> findings;                ///< those among the warnings that reading found in the data
    long first_row = 0;                           ///< row of the file (from 1) of the first sample

    std::size_t sampleCount() const { return time.size(); }
    /// nullptr if there is none.
    const Channel* find(const std::string& name) const;
    /// Mean sample interval, s; 0 with fewer than two samples.
    double sampleInterval() const;
    /// Connections that have a channel of this part, in order of first appearance.
    std::vector<std::string> connections(Part part) const;
};

}  // namespace wems
