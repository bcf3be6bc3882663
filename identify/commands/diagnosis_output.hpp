/// @file
/// A diagnosis as data, as a readable argument, in one sentence, and as a page.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "identify/verdict/diagnosis.hpp"
#include "models/common/atomic_file.hpp"
#include "models/common/text_table.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify::commands {

nlohmann::json makeDiagnosisJson(const Diagnosis& diagnosis);
/// A round of the search as a sentence, and its candidates with their log odds.
std::string describeDecision(const Decision& decision);
std::vector<std::vector<std::string>> tabulateCandidates(const Decision& decision);
inline const std::vector<std::string> kFittedColumns{"fitted", "log evidence", "error %", "outcome"};
std::vector<std::vector<std::string>> tabulateFitted(const Decision& decision);
/// Name, believed value, tolerance, value, interval and unit of each number that moved within its tolerance.
std::vector<std::vector<std::string>> tabulateAdjustments(const Diagnosis& diagnosis);
/// A row for each parameter of each cause: cause, probability and gain in its first row, then name, value, 95 %
/// interval and unit.
std::vector<std::vector<std::string>> tabulateCauses(const Diagnosis& diagnosis);
/// Whether numbers were adjusted within their tolerances.
bool usesTolerances(const Diagnosis& diagnosis);
/// What the prediction bands say, which must be known. @param what `runs` or `recordings`
std::string describeAllowed(const Diagnosis& diagnosis, const std::string& what);
/// Errors of the free simulation of the identification and the validation recordings: before, with the adjustments
/// where there are any, after, noise alone.
std::vector<std::vector<std::string>> tabulateErrors(const Diagnosis& diagnosis);
std::string formatDiagnosis(const Diagnosis& diagnosis, TextStyle style);

/// The cause that explains most, with its largest number beside what the model has, lengths in mm and stiffnesses in
/// N/mm: `The centre of gravity lies 16.49 ± 0.29 mm above where the model has it; this explains 99 % of the error.`
/// Without a cause what the verdict means.
/// @param believed the model that was diagnosed
std::string makeHeadline(const Diagnosis& diagnosis, const MountModel& believed);

struct DiagnosedRuns {
    const std::vector<Recording>& identification;
    const std::vector<Recording>& validation;  ///< may be empty
};

/// Verdict, errors, the runs in motion, causes with their ties, restoring forces and free simulations before and after,
/// every round with its candidates and why one was taken or none, and the spectrum of the residual.
/// @param model as given
/// @throws InputError if the file cannot be written
void writeDiagnosisReport(const Diagnosis& diagnosis, const MountModel& model, const DiagnosedRuns& runs,
                          const std::string& title, const std::string& file, OutputFiles& outputs);

}  // namespace wems::identify::commands
