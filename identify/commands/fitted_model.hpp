/// @file
/// What a fit found, as a model that every command reads.
#pragma once

#include <string>

#include "models/atomic_file.hpp"
#include "models/mount_model.hpp"

namespace wems::identify::commands {

/// Adds a fitted model to the outputs.
/// @param fitted within what a model may hold (makeAdmissible)
/// @throws InputError if a fitted value still keeps it from being a model
void addFittedModel(const MountModel& fitted, const std::string& file, OutputFiles& outputs);

}  // namespace wems::identify::commands
