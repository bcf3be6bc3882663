/// @file
/// A recording that the fast forward model makes of what drives another one.
#pragma once

#include <string>

#include "identify/commands/recordings.hpp"

namespace wems::identify::commands {

struct FastSimulationRequest {
    RecordingSource drive;  ///< whose load and base acceleration act, or, without both, the motion of the fixed part
    ModelSource model;
    std::string columns;  ///< file; may be empty
};

/// Displacements and accelerations of both parts at all connections, from rest, at the drive's times.
/// @throws InputError: nothing drives, the motion cannot be recovered; SimulationDiverged
Recording runFastSimulation(const FastSimulationRequest& request, Watcher& watcher);

}  // namespace wems::identify::commands
