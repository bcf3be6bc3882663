/// @file
/// One pass of the diagnosis: from recordings with some faults corrected to motions, equations and selected causes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/exact/channel_faults.hpp"
#include "identify/exact/open_loop_problem.hpp"
#include "identify/exact/selection.hpp"
#include "identify/motion/motion.hpp"
#include "identify/verdict/free_error.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

/// Ordinary calibration of a channel, standard deviation relative to its gain.
inline constexpr double kGainScatter = 1e-3;

/// Runs that identify, or runs that judge, with all that the steps need. Not copied: the free runs point at the
/// motions.
struct RunGroup {
    std::vector<RunMotion> motions;
    std::vector<FreeRun> free_runs;
    std::vector<Eigen::VectorXd> swept;  ///< Hz

    /// @throws InputError if the motion cannot be recovered
    RunGroup(const std::vector<Recording>& recordings, const MountModel& model);
    RunGroup(const RunGroup&) = delete;
    RunGroup& operator=(const RunGroup&) = delete;
    OpenLoopProblem makeProblem(const MountModel& model) const;
};

/// Recordings without the faults, but for the one with index `kept` (none if there is no such).
std::vector<Recording> correctFaults(const std::vector<Recording>& recordings, const std::vector<ChannelFault>& faults,
                                     std::size_t kept);

struct Pass {
    RunGroup fit_group, judge_group;
    OpenLoopProblem fit_problem, judge_problem;
    Selection selection;

    /// @param faults corrected in both groups
    Pass(const std::vector<Recording>& identification, const std::vector<Recording>& judges,
         const std::vector<ChannelFault>& faults, const MountModel& model, const SelectionOptions& options);
};

}  // namespace wems::identify
