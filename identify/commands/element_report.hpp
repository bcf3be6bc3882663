/// @file
/// The page that `identify diagnose --report` writes of component tests.
#pragma once

#include <string>

#include "identify/commands/diagnose.hpp"

namespace wems::identify::commands {

/// Verdict, errors, causes, adjustments, and each test's force over displacement and over time: measured, by the
/// model's law and by the extended one.
/// @throws InputError if the file cannot be written
void writeElementReport(const DiagnoseAnswer& answer, const std::string& file, OutputFiles& outputs);

}  // namespace wems::identify::commands
