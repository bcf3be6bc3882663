/// @file
/// What the simulation gets wrong, the named causes, the extended model, the gain.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "identify/commands/recordings.hpp"
#include "identify/component/component_data.hpp"
#include "identify/verdict/diagnosis.hpp"
#include "models/common/atomic_file.hpp"
#include "models/common/text_table.hpp"

namespace wems::identify::commands {

struct DiagnoseRequest {
    RunSelection runs;
};

struct DiagnoseAnswer {
    Diagnosis diagnosis;
    MountModel model;      ///< as given
    MountModel extended;   ///< within what a model may hold
    bool element = false;  ///< the recordings are tests of one element
    std::vector<Recording> identification, validation;
    std::vector<std::string> warnings;  ///< about the choice of runs
    std::vector<std::string> notes;     ///< how the extended model was brought within what a model may hold
    std::string title;
    ResultRecord record;
};

/// @throws InputError
DiagnoseAnswer runDiagnosis(DiagnoseRequest request, Watcher& watcher);

nlohmann::json toJson(const DiagnoseAnswer& answer);
/// Without the notes.
std::string formatText(const DiagnoseAnswer& answer, TextStyle style);
void writeReport(const DiagnoseAnswer& answer, const std::string& file, OutputFiles& outputs);

// The page that `identify diagnose --report` writes of component tests.

/// Verdict, errors, causes, adjustments, and each test's force over displacement and over time: measured, by the
/// model's law and by the extended one.
/// @throws InputError if the file cannot be written
void writeElementReport(const DiagnoseAnswer& answer, const std::string& file, OutputFiles& outputs);

}  // namespace wems::identify::commands
