/// @file
/// The HTML page of `identify rigidity`.
#pragma once

#include <string>
#include <vector>

#include "identify/motion/rigidity.hpp"
#include "models/atomic_file.hpp"
#include "models/device_drawing.hpp"
#include "models/text_table.hpp"

namespace wems::identify::cli {

/// Table, sentences (suspects, notes), the checks over time and swept frequency, and the device in motion where all six
/// motions can be recovered. @throws InputError if `file`
/// cannot be written.
void writeRigidityReport(const Rigidity& rigidity, const Table& table, const std::vector<std::string>& sentences,
                         const Recording& recording, const MountModel& model, const std::vector<DrawnShape>& drawing,
                         const std::string& file, OutputFiles& outputs);

}  // namespace wems::identify::cli
