/// @file
/// The runs that a diagnosis was judged by, as its report draws them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/fit/remainder.hpp"
#include "identify/motion/motion.hpp"
#include "identify/verdict/diagnosis.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::commands {

/// Runs that a report draws at most, so that the page stays small.
inline constexpr std::size_t kMostDrawn = 3;

/// Places in the palette of the plots.
inline constexpr int kMeasuredColor = 6, kBeforeColor = 1, kAfterColor = 0, kNoiseColor = 2;

/// Channels corrected by the faults that the diagnosis found.
struct JudgedRun {
    Recording recording;
    RunMotion motion;
};

/// The first `most` of the recordings.
std::vector<JudgedRun> prepareJudgedRuns(const std::vector<Recording>& recordings, const Diagnosis& diagnosis,
                                         std::size_t most);

/// An axis of a connection.
struct AxisPlace {
    std::size_t connection = 0, axis = 0;
    /// `4.z`
    std::string name(const MountModel& model) const;
    /// Row of what has three for each connection.
    Eigen::Index row() const { return static_cast<Eigen::Index>(3 * connection + axis); }
};

/// The axis that a diagnosis speaks of: where the first cause of an axis sits, or what is left unexplained; nothing if
/// it speaks of none.
std::optional<AxisPlace> findNamedAxis(const Diagnosis& diagnosis);

// Free simulations before and after in the report of a diagnosis: envelope and error over swept frequency, orders.

/// @param noise_floor what the noise alone leaves, relative to the measured motion
/// @param named axis whose envelope and orders are drawn; absent: the one that moves most
void addSimulatedRuns(HtmlReport& page, const std::vector<JudgedRun>& runs, const MountModel& before,
                      const MountModel& after, double noise_floor, const std::optional<AxisPlace>& named);

// What the fitted equations of motion leave of a run, as a report shows it: over time, over frequency, and its
// autocorrelation.

void addRemainder(HtmlReport& page, const RunRemainder& run, const std::string& name);

}  // namespace wems::identify::commands
