/// @file
/// One pass of the diagnosis: from recordings with some faults corrected to motions, equations and selected causes.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "identify/diagnose/channel_faults.hpp"
#include "identify/diagnose/open_loop_problem.hpp"
#include "identify/diagnose/selection.hpp"
#include "identify/motion/motion.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

// The error of a free simulation against recordings, as the results define it.
//
// Error: root mean square of (simulated − measured) relative displacement over that of the measured one, pooled over
// all recordings, connections and axes. The simulation is driven by the recorded load wherever the model has a
// bracket and the recording a load, otherwise by the recorded motion of the fixed part. Where only accelerations were
// recorded, both sides are compared above the lowest frequency at which the motion is known.

/// Measured relative displacement of a run: row 3 i + axis, F axes, m; rows of connections that were not recorded are
/// those of the rigid motion.
Eigen::MatrixXd calcMeasuredRelative(const Recording& recording, const RunMotion& run, const MountModel& model);

struct FreeError {
    double error = 0;        ///< see above
    double noise_floor = 0;  ///< what the recordings' noise alone gives
    bool diverged = false;   ///< a simulation grew beyond all bounds; error is then infinite
};

/// One run with what it is compared with.
struct FreeRun {
    const RunMotion* motion;
    Eigen::MatrixXd measured;
    /// m², of the displacement channels of the mobile and the fixed part, where their noise is known better than by the
    /// scatter of the rigid fits.
    std::optional<std::array<double, 2>> displacement_noise = {};
};
/// Simulated minus measured, as the error compares them. @throws SimulationDiverged
Eigen::MatrixXd calcFreeResidual(const FreeRun& run, const MountModel& model);
/// What the recording's noise gives one relative displacement, m².
double calcNoiseVariance(const FreeRun& run, const MountModel& model);
FreeError calcFreeError(const std::vector<FreeRun>& runs, const MountModel& model);

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
