/// @file
/// The next test: of a declared list of sweeps the one that tells most of what the runs so far leave open.
///
/// 1. The recorded runs are fitted (fitMount): values, noise, what is not identifiable.
/// 2. Each candidate is simulated with the fitted model and measured with the noise that was found (Rehearsal).
/// 3. Recorded runs and candidate are fitted together, by the same code as a user's fit of them would be: the
///    candidate's information joins that of the recorded runs with the weight that its residual gives it. What a fit of
///    both would call known, and how exactly, is the answer.
/// 4. Candidates that exceed a limit get the largest level of a geometric ladder below it that keeps it.
///
/// 5. What the first of them promises is asked of devices that runs and tolerances leave possible (PossibleDevices).
///    Each is rehearsed and fitted like the first. Only what holds with all of them is promised, and the run that then
///    leads is the proposal.
///
/// This is optimal design by exchange over a finite list with the local linearisation at the present estimate; the
/// criterion is not the determinant of the information but what a reader asks first, groups separated, then
/// directions known, then widths of the widest intervals.
///
/// Source: Fedorov, Theory of Optimal Experiments (1972); Atkinson, Donev and Tobias, Optimum Experimental Designs,
/// with SAS (2007), ch. 17 (local optimality of nonlinear models).
#pragma once

#include <string>
#include <vector>

#include "identify/plan/gain.hpp"
#include "identify/plan/rehearsal.hpp"
#include "models/common/progress.hpp"

namespace wems::identify {

struct PlanOptions {
    FitOptions fit;
    AskedSetup asked;
    std::size_t most_proposals = 5;
    ProgressListener progress;  ///< may be empty
};

struct Proposal {
    PlannedRun candidate;
    RunExtent extent;
    Gain gain;
    bool confirmed = false;  ///< gain with every possible device, not of the fitted one alone
};

/// A group that no run of the list separates.
struct UnreachedTie {
    std::vector<std::string> names;
    std::string separate_by;  ///< as the fit says it
    /// Known then, with the first member of the group in it, and the proposal (from 0) that tells it; empty without.
    std::string combination;
    std::size_t proposal = 0;
};

struct Plan {
    FitResult now;  ///< of the recorded runs
    TestSetup setup;
    std::vector<Proposal> proposals;  ///< best first; those that tell something
    std::size_t rehearsed = 0;        ///< candidates whose gain was calculated
    std::vector<UnreachedTie> unreached;
    /// Numbers of proposals (from 0) that together separate all groups that any of them does, the best first.
    std::vector<std::size_t> together;
    /// False where the fit leaves more than noise: then the intervals hold only as far as the model does.
    bool trusted = true;
    std::vector<std::string> notes;
};

/// @param runs motions of the recordings, in the same order
/// @throws InputError as fitMount() and findTestSetup()
Plan makePlan(const std::vector<RunMotion>& runs, const std::vector<Recording>& recordings, const MountModel& model,
              const PlanOptions& options);

}  // namespace wems::identify
