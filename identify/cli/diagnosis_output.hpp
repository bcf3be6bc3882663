/// @file
/// A diagnosis as data and as a readable argument.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "identify/diagnose/diagnosis.hpp"

namespace wems::identify::cli {

nlohmann::json makeDiagnosisJson(const Diagnosis& diagnosis);
std::string formatDiagnosis(const Diagnosis& diagnosis);

}  // namespace wems::identify::cli
