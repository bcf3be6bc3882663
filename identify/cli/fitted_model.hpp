/// @file
/// What a fit found, as a model that every command reads.
#pragma once

#include <string>
#include <vector>

#include "models/atomic_file.hpp"
#include "models/mount_model.hpp"

namespace wems::identify::cli {

/// Brings `fitted` within what a model may hold (makeAdmissible), which `notes` says, and adds it to the outputs.
/// @param believed model that the fit began with
/// @throws InputError if a fitted value still keeps it from being a model
void addFittedModel(const MountModel& believed, MountModel fitted, const std::string& file,
                    std::vector<std::string>& notes, OutputFiles& outputs);

}  // namespace wems::identify::cli
