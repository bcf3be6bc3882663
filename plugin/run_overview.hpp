/// @file
/// A long recording as a report draws it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "models/common/text_table.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"
#include "plugin/device.hpp"
#include "plugin/drive.hpp"

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

namespace wems {

// How far and how hard each connection was worked in a run, for its report.

class HtmlReport;

}  // namespace wems

namespace wems::plugin {

/// Relative displacement and force of each axis of each connection, from the simulation itself, without the sensors'
/// noise; in memory that does not grow with the run.
class ConnectionOverview {
public:
    /// @param model must outlive the object @param samples of the whole run
    ConnectionOverview(const MountModel& model, std::size_t samples);
    void add(double time, const DeviceMotion& motion);

    /// One sentence: the deepest contact, or the least clearance that was left, and the largest force.
    std::string makeHeadline(const Drive& drive) const;
    /// Extremes, forces and clearances left; axes that stood still are left out.
    Table makeTable(const Drive& drive) const;
    /// Over the swept frequency the largest value of each of some hundred stretches, over time the motion itself; what
    /// stood still is left out. @param time_offset s, added to all times
    void addPictures(HtmlReport& report, const Drive& drive, double time_offset) const;

private:
    struct AxisExtremes {
        double lowest = 0, highest = 0, largest_force = 0;  // m, m, N (signed)
        double lowest_time = 0, highest_time = 0;           // s
        double largest() const { return std::max(-lowest, highest); }
        double largestTime() const { return highest > -lowest ? highest_time : lowest_time; }
    };
    struct Margin {
        std::string stop;
        double left = 0;  // m; below zero: pressed by so much
        double time = 0;  // s, of the motion farthest towards the stop
    };
    bool moves(std::size_t axis) const;
    std::string nameAxis(std::size_t axis) const;
    std::vector<Margin> listMargins(std::size_t axis) const;

    const MountModel& model_;
    RunOverview history_;
    std::vector<double> row_;
    std::vector<AxisExtremes> axes_;  // 3 for each connection
    double farthest_ = 0, strongest_ = 0;
};

/// Whether the drive has one frequency that changes.
bool isSwept(const Drive& drive);

}  // namespace wems::plugin
