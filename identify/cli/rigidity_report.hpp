/// @file
/// The HTML page of `identify rigidity`.
#pragma once

#include <string>
#include <vector>

#include "identify/motion/rigidity.hpp"
#include "models/text_table.hpp"

namespace wems::identify::cli {

/// Table, sentences (suspects, notes), and the checks over time and swept frequency. @throws InputError if `file`
/// cannot be written.
void writeRigidityReport(const Rigidity& rigidity, const Table& table, const std::vector<std::string>& sentences,
                         const std::string& recording, const std::string& file);

}  // namespace wems::identify::cli
