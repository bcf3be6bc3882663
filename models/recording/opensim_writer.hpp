/// @file
/// Recordings to OpenSim's text formats.
#pragma once

#include <string>
#include <vector>

#include "models/recording/recording_writer.hpp"

namespace wems {

/// Displacements as positions of markers `mobile.<connection>`, `fixed.<connection>`, mm. Everything else is left out,
/// which the returned sentences say. Exceptions as writeRecording().
std::vector<std::string> writeTrc(const Recording& recording, const std::string& file, const WriteOptions& options);

/// Every channel in SI, labelled by its name (.sto, .mot).
void writeStorage(const Recording& recording, const std::string& file, const WriteOptions& options);

}  // namespace wems
