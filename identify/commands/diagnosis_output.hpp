/// @file
/// A diagnosis as data and as a readable argument.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "identify/diagnose/diagnosis.hpp"
#include "models/terminal.hpp"

namespace wems::identify::commands {

nlohmann::json makeDiagnosisJson(const Diagnosis& diagnosis);
/// At which axis alone a force could make most of what the mount leaves, if it leaves more than noise.
std::string describePlace(const Round& round);
/// A round of the search with tolerances as a sentence, and its candidates with their log odds.
std::string describeDecision(const Decision& decision);
std::vector<std::vector<std::string>> tabulateCandidates(const Decision& decision);
/// Name, believed value, tolerance, value, interval and unit of each number that moved within its tolerance.
std::vector<std::vector<std::string>> tabulateAdjustments(const Diagnosis& diagnosis);
/// A row for each parameter of each cause: cause, probability and gain in its first row, then name, value, 95 %
/// interval and unit.
std::vector<std::vector<std::string>> tabulateCauses(const Diagnosis& diagnosis);
/// Whether numbers were adjusted within their tolerances.
bool usesTolerances(const Diagnosis& diagnosis);
/// Errors of the free simulation of the identification and the validation recordings: before, with the adjustments
/// where there are any, after, noise alone.
std::vector<std::vector<std::string>> tabulateErrors(const Diagnosis& diagnosis);
std::string formatDiagnosis(const Diagnosis& diagnosis, TextStyle style);

}  // namespace wems::identify::commands
