/// @file
/// The runs that a diagnosis was judged by, as its report draws them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/diagnose/diagnosis.hpp"
#include "identify/motion/motion.hpp"

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

}  // namespace wems::identify::commands
