/// @file
/// The error of a model on a run: its free simulation against the measured relative displacements.
#pragma once

#include <optional>

#include "identify/forward/compare.hpp"
#include "identify/forward/drive.hpp"
#include "identify/forward/initial_state.hpp"

namespace wems::identify {

/// A run prepared for being simulated many times with changing parameters: drive tables and measured displacements.
struct PreparedRun {
    Drive drive;
    RelativeDisplacement measured;
    std::optional<StartMotion> start;  ///< empty: rest
    bool fixed_integrated = false;     ///< the fixed part's motion is integrated from accelerations, and simulated
};

/// @param lowest_frequency Hz, lowest excited frequency; only used where the run rests on accelerations alone
/// @param model chooses the step and the way of driving (load wherever there is a bracket and a load)
PreparedRun prepareRun(const RunMotion& run, const MountModel& model, double lowest_frequency);

/// Free simulation from the run's start (rest, or the motion that it begins with), relative displacements from rest;
/// filtered as the measured ones are. Where those are integrated from accelerations, so is what the simulated ones
/// would be recorded as: the kinks that contact leaves in accelerations fold into low frequencies at each sampling
/// rate, which integration magnifies (2 % of the displacement at 1 kHz, falling with the rate squared).
RelativeDisplacement simulateRun(const MountModel& model, const PreparedRun& run);

/// The sums of squares, to be pooled over runs. @throws SimulationDiverged
ErrorSum calcSimulationError(const MountModel& model, const PreparedRun& run);

}  // namespace wems::identify
