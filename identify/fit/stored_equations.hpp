/// @file
/// The equations of one run as a file, so that many runs can be worked on side by side and be solved together: runs
/// add.
///
/// A file holds what solveEquations() asks of a run and nothing more: the columns of the equations, the samples in
/// which a stop may be touched, and the motion with its noise, which the intervals follow from. Numbers are the
/// processor's own, so that a fit of stored equations is the fit of the runs to the last bit. The format is of
/// one version of the program and one kind of processor, not for keeping.
#pragma once

#include <string>

#include "identify/fit/equation_of_motion.hpp"
#include "identify/fit/fit.hpp"
#include "models/common/atomic_file.hpp"

namespace wems::identify {

// The equations of one run as fitMount() sets them up, and the solution of those of several runs.

/// Test function as the options say, or chosen from the run's channels and rate.
/// @throws InputError if the run is too short
RunEquations makeRunEquations(const RunMotion& run, const MountModel& model, const FitOptions& options);

/// The rest of fitMount(): all parameters from the equations of all runs.
FitResult solveEquations(const std::vector<RunMotion>& runs, std::vector<RunEquations> equations,
                         const MountModel& model, const FitOptions& options);

struct StoredRun {
    RunMotion motion;
    RunEquations equations;
};

/// @throws InputError if the run is too short, or lacks its slow motion (accelerations alone), which follows from all
///         runs together
StoredRun makeStoredRun(RunMotion motion, const MountModel& model, const FitOptions& options);

void writeStoredRun(const StoredRun& run, const MountModel& model, const FitOptions& options, const std::string& file,
                    OutputFiles& outputs);

/// @throws InputError if the file is none of these, is cut off, or was made with another model or other options
StoredRun readStoredRun(const std::string& file, const MountModel& model, const FitOptions& options);

}  // namespace wems::identify
