/// @file
/// A long recording as a report draws it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "models/recording/recording.hpp"

namespace wems::plugin {

/// A channel's samples; of a long run the smallest and the largest of each of many stretches of equal length.
struct ThinnedChannel {
    std::string name;
    std::vector<double> time, values;  ///< s, SI
};

/// Collects what a report draws from blocks of rows, in memory that does not grow with the run.
class RunOverview {
public:
    /// @param samples of the whole run
    RunOverview(const Recording& header, std::size_t samples);
    void add(const Recording& rows);
    /// One row, a value for each channel.
    void add(double time, const std::vector<double>& values);
    /// nullptr if there is no such channel.
    const ThinnedChannel* find(const std::string& name) const;

private:
    struct Extreme {
        double time = 0, value = 0;
    };
    struct Stretch {
        Extreme lowest, highest;
    };
    void close(std::size_t channel);

    static constexpr std::size_t most_stretches = 20000;  // a plot shows some 4000 points
    std::size_t length_;                                  // samples in a stretch
    std::size_t filled_ = 0;                              // of the present stretch
    std::vector<Stretch> present_;                        // one for each channel
    std::vector<ThinnedChannel> channels_;
};

}  // namespace wems::plugin
