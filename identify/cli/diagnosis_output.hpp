/// @file
/// A diagnosis as data and as a readable argument.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "identify/diagnose/diagnosis.hpp"
#include "models/terminal.hpp"

namespace wems::identify::cli {

nlohmann::json makeDiagnosisJson(const Diagnosis& diagnosis);
/// At which axis alone a force could make most of what the mount leaves, if it leaves more than noise.
std::string describePlace(const Round& round);
std::string formatDiagnosis(const Diagnosis& diagnosis, TextStyle style);

}  // namespace wems::identify::cli
